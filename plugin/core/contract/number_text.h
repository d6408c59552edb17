#pragma once

#include <iomanip>
#include <sstream>
#include <string>

namespace spectral {

/// A number with so many significant digits.
inline std::string numberText(double number, int digits) {
    std::ostringstream text;
    text << std::setprecision(digits) << number;
    return text.str();
}

/// "0.24 (12 %)": a length, also as a percentage of the diagonal.
inline std::string lengthText(double length, int digits, double diagonal) {
    return numberText(length, digits) + " (" + numberText(100.0 * length / diagonal, 3) + " %)";
}

/// A share in percent, to two or three digits.
inline std::string percentOf(double share) {
    return numberText(100.0 * share, share < 0.1 ? 2 : 3) + " %";
}

}  // namespace spectral
