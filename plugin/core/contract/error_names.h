#pragma once

#include "core/support/errors.h"

namespace spectral {

// Names of errors, for Python.

/// The code in snake case: "no_faces".
const char* nameOf(ErrorCode code);

/// The class of meshlab_spectral.errors: "MeshError".
const char* classOf(const Error& error);

}  // namespace spectral
