#include "lanczos.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tridiagonal.h"

namespace spectral {

namespace {

/// Columns by which a basis grows.
constexpr Index kCapacity = 32;

/// Norm below which a new direction is round-off: the space is invariant, the result exact.
constexpr double kBreakdown = 1e-13;

}  // namespace

LanczosColumn::LanczosColumn(const Eigen::VectorXd& start)
    : basis_(start.size(), std::min(kCapacity, start.size())), norm_(start.norm()) {
    exhausted_ = !(norm_ > 0.0);
    if (!exhausted_) basis_.col(0) = start / norm_;
}

void LanczosColumn::extend(Eigen::VectorXd w) {
    const Index j = dimension();
    const double scale = w.norm();
    // The three-term recurrence first, so that the pass over the whole basis finds next to nothing
    // and is needed only once: it is memory traffic, the dearest part after the solves.
    alpha_.push_back(basis_.col(j).dot(w));
    w -= alpha_.back() * basis_.col(j);
    if (j > 0) w -= beta_.back() * basis_.col(j - 1);
    const double before = w.norm();
    reorthogonalize(w);
    double beta = w.norm();
    if (beta < 0.5 * before) {  // much was found: what round-off left of it goes now
        reorthogonalize(w);
        beta = w.norm();
    }
    if (!(beta > kBreakdown * scale) || j + 1 == basis_.rows()) {
        exhausted_ = true;
        return;
    }
    beta_.push_back(beta);
    if (j + 1 == basis_.cols())
        basis_.conservativeResize(Eigen::NoChange,
                                  std::min(basis_.rows(), basis_.cols() + kCapacity));
    basis_.col(j + 1) = w / beta;
}

LanczosColumn::Ritz LanczosColumn::ritz(double pole) const {
    const Index m = dimension();
    if (m == 0) return {};
    TridiagonalEigenpairs T = eigenpairsOfTridiagonal(alpha_, beta_);
    Ritz pairs{Eigen::VectorXd(m), std::move(T.vectors)};
    for (Index i = 0; i < m; ++i) {
        // theta = 1/(lambda + pole); round-off may push it out of (0, 1/pole].
        const double theta = T.values[i];
        const double lambda = theta > 0.0 ? std::max(0.0, 1.0 / theta - pole)
                                          : std::numeric_limits<double>::infinity();
        pairs.omega[i] = std::sqrt(lambda);
    }
    return pairs;
}

Eigen::VectorXd LanczosColumn::coefficients(const Gain& gain, double pole) const {
    if (dimension() == 0) return Eigen::VectorXd();
    const Ritz pairs = ritz(pole);
    Eigen::VectorXd gains(pairs.omega.size());
    for (Index i = 0; i < gains.size(); ++i) gains[i] = gain(pairs.omega[i]);
    return norm_ * (pairs.Q * gains.cwiseProduct(pairs.Q.row(0).transpose()));
}

Quadrature LanczosColumn::quadrature(double pole) const {
    if (dimension() == 0) return {};
    Ritz pairs = ritz(pole);
    return {std::move(pairs.omega), norm_ * norm_ * pairs.Q.row(0).transpose().cwiseAbs2()};
}

void LanczosColumn::reorthogonalize(Eigen::VectorXd& w) const {
    const auto Q = basis_.leftCols(dimension());
    const Eigen::VectorXd overlap = Q.transpose() * w;
    w.noalias() -= Q * overlap;
}

bool extendColumns(std::vector<LanczosColumn>& columns, const Eigen::VectorXd& sqrtD,
                   const ConstantModes& constants, const ShiftedCholesky& cholesky) {
    std::vector<LanczosColumn*> active;
    for (LanczosColumn& column : columns)
        if (!column.exhausted()) active.push_back(&column);
    if (active.empty()) return false;
    Eigen::MatrixXd block(sqrtD.size(), static_cast<Index>(active.size()));
    for (std::size_t a = 0; a < active.size(); ++a)
        block.col(a) = sqrtD.cwiseProduct(active[a]->current());
    block = cholesky.solve(block);
    // S keeps the complement of the constants; round-off does not, and S amplifies it most there.
    constants.remove(block);
    block = sqrtD.asDiagonal() * block;
    for (std::size_t a = 0; a < active.size(); ++a) active[a]->extend(block.col(a));
    return true;
}

}  // namespace spectral
