#pragma once

#include <common/parameters/rich_parameter_list.h>

#include <string>

#include "core/support/errors.h"

/// What is wrong, from the core, and which parameter or MeshLab filter mends it.
///
/// @param parameters  of the filter that failed: only those that it has are recommended.
std::string errorMessage(const spectral::Error& error, const RichParameterList& parameters);
