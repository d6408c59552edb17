#pragma once

#include <string>

#include "core/noise/diagnosis.h"

namespace spectral {

/// The kind as one word, such as "white", for programs.
std::string kindText(NoiseKind kind);

/// The noise of a mesh, such as "white noise: height 0.2 edges (0.0051)"; or why there is none to
/// remove, with what to try.
std::string noiseText(const Diagnosis& diagnosis);

/// "a spike" or "spikes at 12 vertices"; empty if there are none.
std::string spikesText(const Diagnosis& diagnosis);

/// All that was found, in one line.
std::string diagnosisText(const Diagnosis& diagnosis);

/// A length, in mean edges and in length units.
std::string inEdges(double length, double edge);

}  // namespace spectral
