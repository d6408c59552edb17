#pragma once

#include <common/ml_document/mesh_model.h>
#include <common/parameters/rich_parameter_list.h>

#include <string>
#include <vector>

#include "core/filter/fractional_filter.h"
#include "meshlab/mesh_conversion.h"

/// The parameters of the dialog, in the order users decide: what, which size, how strong, how.
RichParameterList fractionalFilterParameters(const MeshModel& mesh);

/// Whether only the details that the filter removes are wanted (`result` = `details`).
/// @throws spectral::InvalidOption  when the value is not one of the dialog's choices.
bool areDetailsWanted(const RichParameterList& parameters);

/// Warnings about parameters that are not at their defaults but have no effect with the others.
std::vector<std::string> unusedParameters(const RichParameterList& parameters);

/// Converts the parameters of a dialog or script to the core's options.
/// @param matrices  of the mesh.
/// @throws spectral::InvalidOption  when a value is not one of the dialog's choices.
spectral::FilterOptions fractionalFilterOptions(const RichParameterList& parameters,
                                                const MeshModel& mesh,
                                                const MeshMatrices& matrices);
