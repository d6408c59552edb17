#pragma once

#include <common/ml_document/mesh_model.h>
#include <common/parameters/rich_parameter_list.h>

#include <string>
#include <vector>

#include "core/transfer/transfer_function.h"
#include "meshlab/mesh_conversion.h"

// The parameters of a transfer function: all filters of shapes and signals share their names,
// defaults and texts.

/// Adds the parameters to a dialog: first what to change and how strongly, then the shape of the
/// gain (`filter_type`, `feature_size`, `pass_gain`, ..., `power`).
void addTransferParameters(const MeshModel& mesh, RichParameterList& list);

/// The transfer function chosen in a dialog or script.
struct ChosenTransfer {
    spectral::TransferFunctionOptions options;
    double featureSize = 0.0;  ///< Length units; for gains at sizes, the middle of these sizes.
};

/// @param mesh  the mesh that relative sizes refer to.
/// @throws spectral::InvalidOption  when an enumeration has no such value, or the custom transfer
///                                  function has a mistake.
ChosenTransfer chosenTransfer(const RichParameterList& parameters, const MeshMatrices& mesh);

/// Warnings about parameters that are not at their defaults but have no effect with the others;
/// they say what would be needed.
std::vector<std::string> unusedTransferParameters(const RichParameterList& parameters);

/// Warns that a parameter has no effect, unless it is used or at its default.
/// @param condition  when it has no effect: "without filter_type = custom".
void warnIfUnused(bool isChanged, bool isUsed, const char* name, const char* condition,
                  std::vector<std::string>& warnings);

/// The name of a filter type, as in the choices of `filter_type`.
std::string nameOf(spectral::FilterType type);
