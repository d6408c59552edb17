#include "slice_iteration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "errors.h"
#include "mass_products.h"

namespace spectral {

namespace {

constexpr int kMaxIterations = 6;

/// Columns that are solved for between two stop points.
constexpr Index kColumns = 16;

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

/// D-orthonormalizes the columns of S by the Cholesky factor of their Gram matrix, whatever their
/// lengths.
void orthonormalize(const Eigen::VectorXd& D, Eigen::Ref<Eigen::MatrixXd> S) {
    const Eigen::MatrixXd gram = gramMatrix(S, D);
    const Eigen::LLT<Eigen::MatrixXd> llt(gram);
    if (llt.info() != Eigen::Success || !gram.allFinite())
        throw SolverFailure("the vectors of a slice have become dependent");
    multiplyInPlace(S, llt.matrixU().solve(Eigen::MatrixXd::Identity(S.cols(), S.cols())));
}

}  // namespace

int iterations(const Slice& slice) {
    // The end of the slice, beside the bound's mu = 1.
    const double end = (slice.bound - slice.middle()) / (slice.to - slice.middle());
    // What vectors have in common with those beyond falls with the distance
    // (UpdateGate::largestLeak).
    const double damping = slice.damping * std::max(1.0, slice.to / (slice.bound - slice.to));
    int degree = 1;
    while (degree < kMaxIterations && !(ChebyshevFilter(degree).beside(end) > damping)) ++degree;
    return degree;
}

void iterate(const Laplacian& laplacian, const ConstantModes& constants, const ShiftedLdlt& factor,
             const Slice& slice, Eigen::Ref<Eigen::MatrixXd> S, const StopPoint& stopPoint) {
    const ChebyshevFilter filter(iterations(slice));
    const double outside = 1.0 / (slice.bound - factor.shift());
    // The least root, 0, is the last.
    for (int i = filter.degree - 1; i >= 0; --i) {
        for (Index first = 0; first < S.cols(); first += kColumns) {
            stopPoint();
            factor.applyResolvent(laplacian.D,
                                  S.middleCols(first, std::min(kColumns, S.cols() - first)),
                                  outside * filter.root(i));
        }
        // Else all columns would come near the eigenvectors next to the shift.
        if (i > 0) orthonormalize(laplacian.D, S);
    }
    for (Index j = 0; j < S.cols(); ++j) constants.remove(S.col(j));
}

}  // namespace spectral
