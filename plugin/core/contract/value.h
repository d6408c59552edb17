#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <variant>

namespace spectral {

/// A value of a parameter or of a report, as hosts pass it on. A choice is its name or its number;
/// a length is a number in length units, or a text (length.h).
using Value = std::variant<bool, int, double, std::string, Eigen::VectorXd>;

/// Values by the names of parameters or report entries.
using Values = std::map<std::string, Value>;

}  // namespace spectral
