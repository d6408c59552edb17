#include "core/denoise/noise_height.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/mesh/measures.h"

namespace spectral {

namespace {

/// Of a shape without noise: the energy in L^2 X over that in L X, both scaled as noise; 0.05 to
/// 0.5 on real meshes.
constexpr double kShapeRatio = 0.17;

/// Vertices off the rim; among fewer, noise and corners are the same.
constexpr Index kFewest = 100;

/// How often the normals are blurred: they are to vary less than the noise does.
constexpr int kBlurs = 3;

/// The median of `count` values; reorders them. 0 for none.
double median(std::vector<double>& values, std::ptrdiff_t count) {
    if (count == 0) return 0.0;
    const auto middle = values.begin() + count / 2;
    std::nth_element(values.begin(), middle, values.begin() + count);
    return *middle;
}

/// The standard deviation of a normal distribution from the moduli of a sample, some of which are
/// of something else, and larger: creases and outliers.
double robustDeviation(std::vector<double> moduli) {
    // The median of the moduli within three deviations, for variance 1.
    constexpr double kMedianWithin = 0.6722, kDeviations = 3.0;
    constexpr int kRepetitions = 5;
    double deviation = medianDeviation(moduli);
    for (int k = 0; k < kRepetitions; ++k) {
        const auto outliers = std::partition(moduli.begin(), moduli.end(), [&](double modulus) {
            return modulus < kDeviations * deviation;
        });
        deviation = median(moduli, outliers - moduli.begin()) / kMedianWithin;
    }
    return deviation;
}

/// L = I - (mean of the neighbours).
SparseMatrix uniformDifferences(const FaceGraph& graph) {
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<int> degree(static_cast<std::size_t>(graph.vertexCount()), 0);
    for (const FaceGraph::Edge& edge : graph.edges)
        for (const int end : edge.ends) ++degree[end];
    for (const FaceGraph::Edge& edge : graph.edges) {
        const auto& [i, j] = edge.ends;
        entries.emplace_back(i, j, -1.0 / degree[i]);
        entries.emplace_back(j, i, -1.0 / degree[j]);
    }
    for (Index i = 0; i < graph.vertexCount(); ++i)
        entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 1.0);
    SparseMatrix L(graph.vertexCount(), graph.vertexCount());
    L.setFromTriplets(entries.begin(), entries.end());
    return L;
}

/// The height of noise that alone would explain S X along the normals N of the vertices.
double heightFrom(const SparseMatrix& S, const FaceGraph& graph, const Vertices& X,
                  const Normals& N) {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(S.rows());
    for (Index j = 0; j < S.cols(); ++j)
        for (SparseMatrix::InnerIterator entry(S, j); entry; ++entry)
            squares[entry.row()] += entry.value() * entry.value();
    const Eigen::VectorXd residual = (S * X).cwiseProduct(N).rowwise().sum();
    std::vector<double> heights;
    for (Index i = 0; i < S.rows(); ++i)
        if (!graph.onRim[i]) heights.push_back(std::abs(residual[i]) / std::sqrt(squares[i]));
    return static_cast<Index>(heights.size()) < kFewest ? 0.0 : robustDeviation(std::move(heights));
}

Normals vertexNormals(const FaceGraph& graph, const Vertices& X) {
    const Vertices ofFaces = blurredNormals(graph, areaNormals(X, graph.F), kBlurs);
    Normals N = Normals::Zero(graph.vertexCount(), 3);
    for (Index t = 0; t < graph.faceCount(); ++t)
        for (int c = 0; c < 3; ++c) N.row(graph.F(t, c)) += ofFaces.row(t);
    normalizeRows(N);
    return N;
}

}  // namespace

double medianDeviation(std::vector<double>& moduli) {
    constexpr double kMedian = 0.6745;  // for variance 1
    return median(moduli, static_cast<std::ptrdiff_t>(moduli.size())) / kMedian;
}

NoiseEstimate estimateNoise(const FaceGraph& graph, const Vertices& X) {
    const Normals N = vertexNormals(graph, X);
    const SparseMatrix L = uniformDifferences(graph);
    const double coarse = heightFrom(L, graph, X, N);
    const double fine = std::min(coarse, heightFrom(L * L, graph, X, N));
    NoiseEstimate noise;
    noise.height = std::sqrt(
        std::max(0.0, (fine * fine - kShapeRatio * coarse * coarse) / (1.0 - kShapeRatio)));
    // Noise lengthens an edge: |e|^2 grows by 2 height^2.
    const double edge = meanEdgeLength(X, graph.F), height = noise.height;
    noise.meanEdge = std::sqrt(std::max(edge * edge - 2.0 * height * height, 0.25 * edge * edge));
    return noise;
}

}  // namespace spectral
