#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/contract/filter.h"
#include "core/support/errors.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// What to do about an error of a filter: other values of its parameters, or filters of MeshLab
/// that mend the mesh. Empty if the error says it.
/// @param given  as for apply.
std::string advice(const Error& error, const Filter& filter, const Values& given);

/// Warns that the requested relative accuracy was not reached.
Warning accuracyWarning(double accuracy, double errorEstimate);

/// The same, and says which gains would be evaluated more accurately.
/// @param type  that of the transfer function; an equalizer's is custom.
Warning accuracyWarning(double accuracy, double errorEstimate, FilterType type);

/// Warns about the least accurate harmonic if it has fewer than six digits.
/// @param residuals  relative residuals of a basis of harmonics; may be empty.
Warnings residualWarnings(const Eigen::VectorXd& residuals);

}  // namespace spectral
