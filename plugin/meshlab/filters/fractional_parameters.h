#pragma once

#include <common/ml_document/mesh_model.h>
#include <common/parameters/rich_parameter_list.h>

#include <string>
#include <vector>

#include "core/filter/fractional_filter.h"
#include "meshlab/mesh_conversion.h"

/// The parameters of the dialog, in the order of decisions: what, which size, how strong, how.
RichParameterList fractionalFilterParameters(const MeshModel& mesh);

/// Whether only the details are wanted that the filter takes away, `result` = `details`.
/// @throws spectral::InvalidOption  when a value is none that the dialog could have.
bool areDetailsWanted(const RichParameterList& parameters);

/// Those that are not at their defaults and have no effect on the others, as warnings.
std::vector<std::string> unusedParameters(const RichParameterList& parameters);

/// The values of the dialog, or of a script, as the core's options.
/// @param matrices  of the mesh.
/// @throws spectral::InvalidOption  when a value is none that the dialog could have.
spectral::FilterOptions fractionalFilterOptions(const RichParameterList& parameters,
                                                const MeshModel& mesh,
                                                const MeshMatrices& matrices);
