#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "core/mesh/surface.h"
#include "fuzz/cases.h"

namespace spectral::fuzz {

/// A promise of the core that a case has broken.
struct Failure {
    std::string kind;  ///< One or two words; failures are counted by kind.
    std::string text;
};

/// @param parts  written one after the other.
template <class... Parts>
Failure failure(const char* kind, const Parts&... parts) {
    std::ostringstream text;
    text.precision(4);
    (text << ... << parts);
    return {kind, text.str()};
}

struct Verdict {
    Outcome outcome;
    std::vector<Failure> failures;
    bool isCompared = false;  ///< With a dense reference.
    bool isExcused = false;   ///< Differs from it no more than round-off in the input explains.
};

/// Runs a case and checks what the headers of the core promise:
///  - only an Error with a message is thrown, and always for an option out of range;
///  - the input is unchanged, and all numbers of a result are finite and consistent;
///  - unreferenced and fixed vertices are left bit-for-bit unchanged, components their
///  centroids;
///  - intrinsic Delaunay weights are non-negative;
///  - repeated, and with two threads, the result is bit-for-bit the same;
///  - a filter of one step is as accurate as it claims, harmonics and energies are those of a dense
///    solver.
///
/// @param compares  whether to compare with a dense solver, which takes most of the time.
Verdict check(const Case& of, bool compares = true);

/// Largest distance of a vertex from the one that it is joined to, which it is drawn onto.
double widestCut(const Vertices& V, const Surface& surface);

}  // namespace spectral::fuzz
