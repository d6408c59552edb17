#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/contract/filter.h"
#include "core/support/errors.h"

namespace spectral {

/// What to do about an error of a filter: other values of its parameters, or filters of MeshLab
/// that mend the mesh. Empty if the error says it.
/// @param given  as for apply.
std::string advice(const Error& error, const Filter& filter, const Values& given);

/// Warns that the requested relative accuracy was not reached, and says what to choose instead.
std::string accuracyWarning(double accuracy, double errorEstimate);

/// Warns about the least accurate harmonic if it has fewer than six digits.
/// @param residuals  relative residuals of a basis of harmonics; may be empty.
std::vector<std::string> residualWarnings(const Eigen::VectorXd& residuals);

}  // namespace spectral
