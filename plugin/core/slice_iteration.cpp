#include "slice_iteration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "errors.h"
#include "mass_products.h"

namespace spectral {

namespace {

/// At the ends of a slice the filter is to be so many times what it is beyond the bound.
constexpr double kDamping = 1e4;

constexpr int kLeastIterations = 2, kMaxIterations = 6;

/// The Chebyshev polynomial T_d of the interval [centre - radius, centre + radius] whose least root
/// is 0 and whose upper end is 1.
struct ChebyshevFilter {
    explicit ChebyshevFilter(int d) : degree(d) {
        const double outermost = std::cos(kPi / (2.0 * d));
        radius = 1.0 / (1.0 + outermost);
        centre = outermost * radius;
    }
    double root(int i) const {
        return centre - radius * std::cos((2.0 * i + 1.0) * kPi / (2.0 * degree));
    }
    /// |T_d| above the interval; it is at most 1 within.
    double beside(double x) const {
        return std::cosh(degree * std::acosh(std::max(1.0, (x - centre) / radius)));
    }

    int degree;
    double centre, radius;
};

/// D-orthonormalizes the columns of S by the Cholesky factor of their Gram matrix.
void orthonormalize(const Eigen::VectorXd& D, Eigen::MatrixXd& S) {
    S.array().rowwise() /= S.colwise().norm().array().eval();
    const Eigen::MatrixXd gram = innerProducts(S, D, S);
    const Eigen::LLT<Eigen::MatrixXd> llt(gram);
    if (llt.info() != Eigen::Success || !gram.allFinite())
        throw SolverFailure("the vectors of a slice have become dependent");
    multiplyInPlace(S, llt.matrixU().solve(Eigen::MatrixXd::Identity(S.cols(), S.cols())));
}

}  // namespace

int iterations(const Slice& slice) {
    // The end of the slice, beside the bound's mu = 1.
    const double end = (slice.bound - slice.middle()) / (slice.to - slice.middle());
    int degree = kLeastIterations;
    while (degree < kMaxIterations && !(ChebyshevFilter(degree).beside(end) > kDamping)) ++degree;
    return degree;
}

void iterate(const Laplacian& laplacian, const ConstantModes& constants, const ShiftedLdlt& factor,
             const Slice& slice, Eigen::MatrixXd& S, const StopPoint& stopPoint) {
    const ChebyshevFilter filter(iterations(slice));
    const double outside = 1.0 / (slice.bound - factor.shift());
    constants.remove(S);
    for (int i = 0; i < filter.degree; ++i) {
        // Else all columns would come near the eigenvectors next to the shift.
        if (i > 0) orthonormalize(laplacian.D, S);
        stopPoint();
        const Eigen::MatrixXd before = outside * filter.root(i) * S;
        S = laplacian.D.asDiagonal() * S;
        factor.solveInPlace(S);
        S -= before;
    }
    constants.remove(S);
    S.array().rowwise() /= S.colwise().norm().array().eval();
}

}  // namespace spectral
