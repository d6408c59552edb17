#pragma once

#include <string>
#include <vector>

namespace spectral {

/// What a warning is about. Programs compare these: texts have numbers, and may change.
enum class WarningCode {
    Selection,
    AllFixed,
    NothingRemoved,  ///< Its text is the summary.
    HighNoise,
    NearlyJoined,
    FlatComponents,
    PeriodicCell,
    FarVertices,
    MissingData,
    PartedComponents,
    BelowEdges,
    ThinParts,
    WholeScaled,
    FoldedFaces,
    VolumeNotKept,
    Accuracy,
    Tolerance,
    FewHarmonics,
    HarmonicResiduals,
    MixedSizes,
    ConstantValues,
    ThinnerThanCutoff,
    LittleMeasured,
    SteepTexture,
    OtherHeights,
    FlatTexture,
    UnusedOption,  ///< The last.
};

/// A shortcoming of a result that is not an error.
struct Warning {
    WarningCode code;
    std::string text;  ///< With what to do; a sentence without the final full stop.
};

using Warnings = std::vector<Warning>;

/// A code for programs, and what it means.
struct WarningKind {
    const char* name;
    const char* meaning;
};

WarningKind kindOf(WarningCode code);

/// All there are.
std::vector<WarningKind> allWarnings();

/// Appends warnings.
void append(Warnings more, Warnings& warnings);

}  // namespace spectral
