#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/analysis/artefacts.h"
#include "core/analysis/geometry_spectrum.h"
#include "core/analysis/manifold_harmonics.h"
#include "core/denoise/denoise.h"
#include "core/filter/fractional_filter.h"
#include "core/support/errors.h"
#include "fuzz/choices.h"
#include "fuzz/meshes.h"

namespace spectral::fuzz {

/// Arguments of `Bands`, which takes no mesh.
struct BandsOptions {
    double diagonal, lowest, highest;
    int perOctave;
};

using Options = std::variant<FilterOptions, ArtefactOptions, HarmonicsOptions, SpectrumOptions,
                             BandsOptions, DenoiseOptions>;
using Result =
    std::variant<FilterResult, Artefacts, ManifoldHarmonics, GeometrySpectrum, DenoiseResult>;

/// One call of an entry point of the core.
struct Case {
    NamedMesh mesh;
    Options options;
    bool mustThrow = false;  ///< An option is out of range.
    bool repeats = false;    ///< Run again, with one thread and with two.
    int cancelAt = 0;        ///< The report at which the caller cancels; 0: never.
    std::string gain;        ///< The text of a custom transfer function.
};

Case makeCase(Choices& choices, Sizes sizes = Sizes::MostlySmall);

Case makeDenoiseCase(Choices& choices);

/// Adds to a filter what older seeds do not encode: custom gains, a part of the mesh, creases,
/// volumes. `choices` must read another stream of bytes. Other entry points are unchanged.
void addPart(Choices& choices, Case& to);

/// The call with all its options, in one line.
std::string describe(const Case& of);

/// The outcome of a call.
struct Outcome {
    std::optional<Result> result;
    std::optional<ErrorCode> code;  ///< Code of an Error of the core.
    std::string text;               ///< Message of any exception.
    bool isProgressSound = true;    ///< All reports were in [0, 1].
};

/// Calls the core; any exception is caught. Not for BandsOptions.
Outcome run(const Case& of, int threads);

/// All numbers of a result, to be compared bit for bit.
std::vector<double> numbersOf(const Result& result);

}  // namespace spectral::fuzz
