#include "core/analysis/texture_filters.h"

#include <algorithm>
#include <cmath>

#include "core/analysis/coarse_surface.h"
#include "core/support/frequency.h"

namespace spectral {

namespace {

/// By how much a mesh lowers the frequencies of waves, c in omega^2 / (1 + c omega^2): as vertices
/// i are joined to j by weights w, in the mean over all directions, c_i = sum_j w |x_i - x_j|^4 /
/// (64 D_i), the next term of the series in which sum_j w |x_i - x_j|^2 / (4 D_i) = 1. Half of all
/// vertices have a larger one: faces without relief may be meshed as coarsely as you like.
double dispersionOf(const Laplacian& laplacian, const Vertices& X) {
    std::vector<double> all;
    for (Index i = 0; i < X.rows(); ++i) {
        double sum = 0.0;
        for (SparseMatrix::InnerIterator entry(laplacian.W, i); entry; ++entry) {
            const double squared = (X.row(i) - X.row(entry.index())).squaredNorm();
            sum -= entry.value() * squared * squared;
        }
        all.push_back(sum / (64.0 * laplacian.D[i]));
    }
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    return std::max(0.0, *middle);
}

/// The low-pass of ISO 16610-61 with a nesting index, exp(-pi (alpha size / wavelength)^2) with
/// alpha = sqrt(ln 2 / pi): 2^-(size / wavelength)^2. Ours is 2^(-w^2 / 2), w = feature size /
/// wavelength, and so the same for a feature size of sqrt(2) nesting indices.
TransferFunction standardGaussian(double size, double dispersion) {
    TransferFunctionOptions gaussian;
    gaussian.dispersion = dispersion;
    return {gaussian, cutoffFrequency(std::sqrt(2.0) * size)};
}

constexpr double kFormAccuracy = 1e-4;  // of what is a correction

}  // namespace

TextureFilters::TextureFilters(const MeshLaplacian& mesh, double size)
    : mesh_(mesh),
      size_(size),
      gaussian_(standardGaussian(size, dispersionOf(mesh.laplacian, mesh.surface.X))),
      evaluator_(gaussian_, kTextureAccuracy, false, Solver::Cheapest) {}

Evaluation TextureFilters::lowPasses(const Eigen::MatrixXd& X, const std::vector<double>& sizes,
                                     double accuracy, const Progress& progress) {
    std::vector<double> powers;
    for (const double size : sizes) powers.push_back(std::pow(size / size_, 2));
    return evaluator_.evaluateAgain(mesh_.laplacian, X, powers, accuracy, progress);
}

SeparatedSignal TextureFilters::separated(const Eigen::MatrixXd& X, double waviness, double noise,
                                          const Progress& progress) {
    std::vector<double> sizes;
    if (waviness > 0.0) sizes = {waviness, std::sqrt(kBend) * waviness};
    if (noise > 0.0) sizes.push_back(noise);
    const Eigen::VectorXd& D = mesh_.laplacian.D;
    const Evaluation done = lowPasses(X, sizes, kTextureAccuracy, progress);
    const double rms = std::sqrt((D.asDiagonal() * X.cwiseAbs2()).sum() / D.sum());
    const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(X.rows(), X.cols());
    SeparatedSignal parts{none, noise > 0.0 ? done.Y.back() : X, none, done.errorEstimate * rms,
                          done.accuracyReached};
    if (waviness > 0.0) {
        parts.waviness = done.Y[0];
        parts.roughness -= done.Y[0];
        parts.bend = done.Y[1] - done.Y[0];
    }
    return parts;
}

Eigen::VectorXd TextureFilters::formOf(const Eigen::VectorXd& h, const std::vector<bool>& isFar,
                                       const Vertices& smooth, double size,
                                       const Progress& progress) {
    constexpr double kCells = 32.0, kStep = 2.0;  // cells in a size, and in what smooths steps
    constexpr double kLeast = 0.01;  // weight that still has a mean; the low-pass is 1e-4 off
    const double step = kStep * size / kCells;
    const CoarseSurface coarse = coarsened(mesh_, smooth, size / kCells);
    const Eigen::VectorXd& D = mesh_.laplacian.D;
    Eigen::MatrixXd means = Eigen::MatrixXd::Zero(coarse.laplacian.D.size(), 2);
    for (Index i = 0; i < h.size(); ++i)
        if (isFar[i]) means.row(coarse.cell[i]) += D[i] * Eigen::RowVector2d(h[i], 1.0);
    means = coarse.laplacian.D.cwiseInverse().asDiagonal() * means;
    // Columns of one size: the accuracy is that of both together.
    const double scale = means.col(0).norm() / means.col(1).norm();
    if (!(scale > 0.0)) return Eigen::VectorXd::Zero(h.size());
    means.col(1) *= scale;
    const TransferFunction F = standardGaussian(std::sqrt(size * size - step * step), 0.0);
    const Eigen::MatrixXd slow =
        FullSpectrumEvaluator(F, kFormAccuracy, false, Solver::Cheapest)
            .evaluate(coarse.laplacian, means, {1.0}, {kFormAccuracy}, progress)
            .Y[0];
    const Eigen::VectorXd form = slow.col(0).cwiseQuotient((slow.col(1) / scale).cwiseMax(kLeast));
    return lowPasses(coarse.constantIn(form), {step}, kFormAccuracy, progress).Y[0];
}

}  // namespace spectral
