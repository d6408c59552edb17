#pragma once

#include <Eigen/Core>

#include "components.h"
#include "laplacian.h"
#include "progress.h"
#include "types.h"

namespace spectral {

/// What a progress report calls the update of a basis.
inline constexpr const char* kUpdateStage = "updating the harmonics";

/// How the harmonics of a previous Laplacian stand to a new one.
struct CandidateSpectrum {
    Eigen::VectorXd quotient;  ///< Of all candidates, ascending: their Rayleigh quotients, about.
    double change = 0.0;       ///< Mean of |D^-1/2 (W phi - q D phi)| / q, q = phi^T W phi, for
                               ///< those looked at, with a length of 1.
};

/// Looks at previous harmonics under a new Laplacian: at some, and next to the cut at all, which
/// are brought into the order of their Rayleigh quotients.
///
/// @param wanted      number of candidates up to the cut.
/// @param candidates  n x m, m >= wanted: the previous harmonics but the constant modes.
/// @throws Cancelled
CandidateSpectrum examineCandidates(const Laplacian& laplacian, const ConstantModes& constants,
                                    Index wanted, Eigen::Ref<Eigen::MatrixXd> candidates,
                                    const Progress& progress);

}  // namespace spectral
