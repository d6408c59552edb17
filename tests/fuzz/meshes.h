#pragma once

#include <string>

#include "fuzz/choices.h"
#include "support/ply.h"

namespace spectral::fuzz {

struct NamedMesh {
    testing::Mesh mesh;
    std::string name;  ///< The shape, and the changes made to it.
};

/// Number of vertices of the meshes, which decides how many cases run per hour.
enum class Sizes {
    Any,          ///< Up to about 400, seldom more.
    MostlySmall,  ///< One in 30 like that, the others 4 to about 60, small ones as often as large.
    Needles       ///< 4 to about 60; all triangles are needles, nearly cocircular in pairs.
};

/// A mesh of any quality: smooth surfaces, soups, needles, spikes, any scale, some that are not
/// meshes at all.
NamedMesh makeMesh(Choices& choices, Sizes sizes);

}  // namespace spectral::fuzz
