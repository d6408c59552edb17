#pragma once

#include <common/parameters/rich_parameter_list.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/support/errors.h"

/// The text of a core error, and the parameter or MeshLab filter that helps.
///
/// @param parameters  of the filter that failed; no others are recommended.
std::string errorMessage(const spectral::Error& error, const RichParameterList& parameters);

/// A warning of an evaluation that stopped short of the accuracy, both relative; what to choose
/// instead comes last.
std::string accuracyWarning(double accuracy, double errorEstimate);

/// A warning of the least accurate harmonic, where it has fewer than six digits.
/// @param residuals  relative, of a basis of harmonics; may be empty.
std::vector<std::string> residualWarnings(const Eigen::VectorXd& residuals);
