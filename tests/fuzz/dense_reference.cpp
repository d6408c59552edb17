#include "fuzz/dense_reference.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "support/dense_eigenpairs.h"

namespace spectral::fuzz {

namespace {

using Scalar = long double;
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

struct Pairs {
    Vector values;
    Matrix vectors;
};

Pairs pairsInDouble(const Matrix& W, const Vector& D) {
    const testing::DenseEigenpairs pairs =
        testing::denseEigenpairs(W.cast<double>(), D.cast<double>());
    return {pairs.values.cast<Scalar>(), pairs.vectors.cast<Scalar>()};
}

Pairs pairsInExtended(const Matrix& W, const Vector& D) {
    const Vector scale = D.cwiseSqrt().cwiseInverse();
    Eigen::SelfAdjointEigenSolver<Matrix> solver(scale.asDiagonal() * W * scale.asDiagonal());
    // Errors relative to the largest eigenvalue become errors relative to their own, by
    // Rayleigh-Ritz with differences along edges.
    Matrix Phi = scale.asDiagonal() * solver.eigenvectors();
    const Index n = W.rows();
    const Vector sums = W.rowwise().sum();
    Matrix ritz = Phi.transpose() * sums.asDiagonal() * Phi;
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < j; ++i) {
            if (W(i, j) == 0) continue;
            const Vector difference = (Phi.row(j) - Phi.row(i)).transpose();
            ritz -= (W(i, j) * difference) * difference.transpose();
        }
    constexpr Scalar kRoundOff = 100 * std::numeric_limits<Scalar>::epsilon();
    const Vector lambda = ritz.diagonal().cwiseAbs();
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i)
            if (std::abs(ritz(i, j)) <= kRoundOff * std::max(lambda[i], lambda[j])) ritz(i, j) = 0;
    solver.compute(ritz);
    return {solver.eigenvalues(), Phi * solver.eigenvectors()};
}

/// W, D and X in extended precision, reordered if perturbed; otherwise rows of W sum to zero.
struct Problem {
    Matrix W, X;
    Vector D;
    std::vector<Index> order;  ///< Vertex of each row.

    Problem(const MeshLaplacian& mesh, Precision precision) : order(mesh.laplacian.D.size()) {
        const auto n = static_cast<Index>(order.size());
        std::iota(order.begin(), order.end(), Index{0});
        std::mt19937 bits(static_cast<unsigned>(precision));
        const bool isPerturbed = precision >= Precision::Perturbed;
        if (isPerturbed)
            for (Index i = n - 1; i > 0; --i) std::swap(order[i], order[bits() % (i + 1)]);
        // A few ulps of double precision, whatever the scalar type.
        const auto factor = [&] {
            constexpr Scalar kUnit = std::numeric_limits<double>::epsilon();
            const Scalar random = static_cast<Scalar>(bits()) / Scalar{4294967296} - Scalar{0.5};
            return isPerturbed ? 1 + 4 * kUnit * random : Scalar{1};
        };
        const Eigen::MatrixXd dense(mesh.laplacian.W);
        W = Matrix::Zero(n, n);
        X.resize(n, 3);
        D.resize(n);
        for (Index i = 0; i < n; ++i) {
            D[i] = static_cast<Scalar>(mesh.laplacian.D[order[i]]) * factor();
            X.row(i) = mesh.surface.X.row(order[i]).cast<Scalar>();
            for (Index j = 0; j < i; ++j)
                W(i, j) = W(j, i) = static_cast<Scalar>(dense(order[i], order[j])) * factor();
        }
        const Vector sums = W.rowwise().sum();
        for (Index i = 0; i < n; ++i) W(i, i) = -sums[i] * factor();
    }
};

/// Subtracts the D-weighted mean of every component from its rows.
void centre(const Vector& D, const std::vector<int>& label, Matrix& X) {
    const int count = label.empty() ? 0 : 1 + *std::max_element(label.begin(), label.end());
    for (int component = 0; component < count; ++component) {
        Eigen::Matrix<Scalar, 1, 3> mean = Eigen::Matrix<Scalar, 1, 3>::Zero();
        Scalar mass = 0;
        for (Index i = 0; i < X.rows(); ++i)
            if (label[i] == component) {
                mean += D[i] * X.row(i);
                mass += D[i];
            }
        for (Index i = 0; i < X.rows(); ++i)
            if (label[i] == component) X.row(i) -= mean / mass;
    }
}

DenseSpectrum spectrumOf(const MeshLaplacian& mesh, const Interior& interior, Precision precision) {
    Problem all(mesh, precision);
    std::vector<Index> rowOf(all.order.size(), -1);  // row in the interior
    const Eigen::MatrixXd marks = interior.extended(Eigen::MatrixXd::Ones(interior.size(), 1));
    for (Index i = 0, m = 0; i < marks.rows(); ++i)
        if (marks(i, 0) > 0.0) rowOf[i] = m++;
    std::vector<Index> rows;  // rows of `all` that can move
    std::vector<int> label, surfaceLabel;
    for (std::size_t i = 0; i < all.order.size(); ++i) {
        surfaceLabel.push_back(interior.surfaceComponents().label[all.order[i]]);
        if (rowOf[all.order[i]] < 0) continue;
        rows.push_back(static_cast<Index>(i));
        label.push_back(interior.components().label[rowOf[all.order[i]]]);
    }
    const auto m = static_cast<Index>(rows.size());
    const Matrix W = all.W(rows, rows);
    const Vector D = all.D(rows);
    centre(all.D, surfaceLabel, all.X);
    Matrix U = all.X(rows, Eigen::indexing::all);

    // X - H where a boundary is fixed: W_II U = (W X)_I.
    std::vector<Index> fixed;
    for (Index i = 0; i < m; ++i)
        if (label[i] < 0) fixed.push_back(i);
    if (!fixed.empty()) {
        const Matrix WX = (all.W * all.X)(rows, Eigen::indexing::all);
        const Matrix right = WX(fixed, Eigen::indexing::all), left = W(fixed, fixed);
        const Matrix solution = left.ldlt().solve(right);
        U(fixed, Eigen::indexing::all) = solution;
    }
    centre(D, label, U);

    const Pairs pairs =
        precision == Precision::Double ? pairsInDouble(W, D) : pairsInExtended(W, D);
    const Matrix c = pairs.vectors.transpose() * (D.asDiagonal() * U);
    DenseSpectrum spectrum;
    spectrum.lambda = pairs.values.cwiseMax(Scalar{0}).cast<double>();
    spectrum.c = c.cast<double>();
    spectrum.energies = c.rowwise().squaredNorm().cast<double>();
    spectrum.Phi.resize(m, m);
    for (Index i = 0; i < m; ++i)
        spectrum.Phi.row(rowOf[all.order[rows[i]]]) = pairs.vectors.row(i).cast<double>();
    return spectrum;
}

}  // namespace

Eigen::MatrixXd DenseSpectrum::change(const Eigen::VectorXd& gains) const {
    return Phi * ((gains.array() - 1.0).matrix().asDiagonal() * c);
}

DenseReference::DenseReference(const Vertices& V, const Faces& F, LaplacianKind kind,
                               Boundary boundary)
    : mesh_(meshLaplacian(V, F, kind)),
      interior_(mesh_.surface.F, mesh_.components, boundary),
      laplacian_(interior_.restricted(mesh_.laplacian)) {}

const DenseSpectrum& DenseReference::at(Precision precision) {
    std::optional<DenseSpectrum>& spectrum = spectra_[static_cast<std::size_t>(precision)];
    if (!spectrum) spectrum = spectrumOf(mesh_, interior_, precision);
    return *spectrum;
}

}  // namespace spectral::fuzz
