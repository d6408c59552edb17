#pragma once

#include <optional>

#include "core/laplacian/constant_modes.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/cholesky.h"

namespace spectral {

/// Splits signals on a surface into what the values at its fixed boundary determine and the rest.
///
/// The former is their harmonic extension H, the function without detail that has these values:
///     W_II H_I = -W_IB X_B,  H_B = X_B.
/// The rest is zero on the boundary: a filter with a fixed boundary acts on it alone,
///     Y = H + F(sqrt(A_II)) (X - H).
/// On a component without boundary H is the D-weighted mean, which every filter keeps.
class HarmonicExtension {
  public:
    /// The argument is kept by reference.
    explicit HarmonicExtension(const Interior& interior) : interior_(interior) {}

    /// Takes the Laplacian of the splits to come.
    /// @throws SolverFailure  when W_II is not positive definite to working precision.
    void setLaplacian(const Laplacian& surface);

    /// A part of a signal.
    struct Rest {
        Eigen::MatrixXd U;  ///< X - H on the interior, rows as there.

        /// How large U is beside X - mean of each component: the larger of the ratios of the
        /// D-norms and of the largest entries, over all columns together.
        double relativeSize = 0.0;
    };

    /// @param X  n x c signals on the surface.
    Rest rest(const Eigen::MatrixXd& X) const;

    int factorizations() const { return cholesky_.factorizations(); }
    int solves() const { return cholesky_.solves(); }

  private:
    const Interior& interior_;
    Laplacian surface_;
    std::optional<ConstantModes> means_;
    ShiftedCholesky cholesky_;
};

}  // namespace spectral
