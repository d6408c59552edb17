#pragma once

#include <string>

#include "core/mesh/mesh.h"
#include "core/support/types.h"

namespace spectral::testing {

struct Mesh {
    Vertices V;
    Faces F;
};

/// Reads a binary little-endian PLY whose vertices are just x, y, z (float or double) and whose
/// faces are just a list of three indices: the form of the meshes that tests and benchmarks use.
/// @throws std::runtime_error  on any other file.
Mesh readPly(const std::string& path);

}  // namespace spectral::testing
