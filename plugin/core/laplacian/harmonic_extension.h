#pragma once

#include "core/laplacian/interior.h"
#include "core/ldlt/shifted_ldlt.h"

namespace spectral {

/// Splits signals on a surface with a fixed boundary into their harmonic extension H and the rest.
///
/// H is determined by the boundary values and adds no detail:
///     W_II H_I = -W_IB X_B,  H_B = X_B.
/// The rest is zero on the boundary; a filter with a fixed boundary acts on it alone,
///     Y = H + F(sqrt(A_II)) (X - H).
/// On a component without a boundary, H is the D-weighted mean, which every filter preserves.
class HarmonicExtension {
  public:
    /// @param interior  kept by reference.
    explicit HarmonicExtension(const Interior& interior) : interior_(interior) {}

    struct Remainder {
        Eigen::MatrixXd U;  ///< X - H at the vertices of the interior.

        /// Size of U relative to X minus the mean of each component: the larger of the ratios of
        /// D-norms and of largest entries, over all columns together.
        double relativeSize = 0.0;
    };

    /// @param surface, inside  Laplacian of the surface, and its restriction to the interior.
    /// @param X                n x c signals on the surface.
    /// @throws SolverFailure  when W_II is not positive definite to working precision.
    Remainder remainder(const Laplacian& surface, const Laplacian& inside,
                        const Eigen::MatrixXd& X);

    int factorizations() const { return ldlt_.factorizations(); }
    int solves() const { return ldlt_.solves(); }

  private:
    const Interior& interior_;
    ShiftedLdlt ldlt_;
};

}  // namespace spectral
