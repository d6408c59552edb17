#pragma once

#include <common/parameters/rich_parameter_list.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/support/errors.h"

/// The text of a core error, with the parameter or MeshLab filter that helps.
///
/// @param parameters  of the filter that failed; only these are recommended.
std::string errorMessage(const spectral::Error& error, const RichParameterList& parameters);

/// Warns that the requested relative accuracy was not reached, and says what to choose instead.
std::string accuracyWarning(double accuracy, double errorEstimate);

/// Warns about the least accurate harmonic if it has fewer than six digits.
/// @param residuals  relative residuals of a basis of harmonics; may be empty.
std::vector<std::string> residualWarnings(const Eigen::VectorXd& residuals);
