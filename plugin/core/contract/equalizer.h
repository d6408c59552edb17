#pragma once

#include <array>
#include <string>

#include "core/mesh/measures.h"

namespace spectral {

/// Sizes of the equalizer's sliders from coarse to fine, as multiples of the smallest size.
inline constexpr std::array<int, 6> kEqualizerTimes{32, 16, 8, 4, 2, 1};

inline constexpr double kMaxEqualizerGain = 4.0;

/// Label of slider i: "Details of 0.24 (12 %)".
std::string equalizerLabel(std::size_t i, double smallestSize, double diagonal);

}  // namespace spectral
