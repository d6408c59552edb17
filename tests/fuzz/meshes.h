#pragma once

#include <string>

#include "fuzz/choices.h"
#include "support/ply.h"

namespace spectral::fuzz {

struct NamedMesh {
    testing::Mesh mesh;
    std::string name;  ///< The shape and what has been done to it.
};

/// A mesh of any quality: smooth surfaces, soups, needles, spikes, any scale, some that are no
/// meshes at all. Up to about 400 vertices, seldom more.
NamedMesh makeMesh(Choices& choices);

}  // namespace spectral::fuzz
