#pragma once

#include <common/parameters/rich_parameter_list.h>

#include <string>

#include "core/support/errors.h"

/// The text of a core error, and the parameter or MeshLab filter that helps.
///
/// @param parameters  of the filter that failed; no others are recommended.
std::string errorMessage(const spectral::Error& error, const RichParameterList& parameters);
