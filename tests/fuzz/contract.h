#pragma once

#include <string>
#include <vector>

#include "fuzz/cases.h"

namespace spectral::fuzz {

/// A promise of the core that a case has broken.
struct Failure {
    std::string kind;  ///< One word or two, to count by.
    std::string text;
};

struct Verdict {
    Outcome outcome;
    std::vector<Failure> failures;
    bool isCompared = false;  ///< With a dense reference.
    bool isExcused = false;   ///< Differs from it, but by no more than round-off in the input does.
};

/// Runs a case and checks what the headers of the core promise:
///  - nothing but an Error with a text is thrown, and an option out of range is one;
///  - the input stays as it is, and all numbers of a result are finite and fit one another;
///  - unreferenced and fixed vertices keep their coordinates to the bit, components their
///  centroids;
///  - repeated, and with two threads, the result is the same to the bit;
///  - a filter of one step is accurate as it claims, harmonics and energies are those of a dense
///    solver.
///
/// @param compares  whether with a dense solver: most of the time.
Verdict check(const Case& of, bool compares = true);

}  // namespace spectral::fuzz
