#pragma once

#include <common/ml_document/mesh_model.h>
#include <common/parameters/rich_parameter_list.h>

#include <string>
#include <vector>

#include "core/transfer/transfer_function.h"
#include "meshlab/mesh_conversion.h"

// The parameters of a transfer function, which all filters of shapes and signals share with the
// same names, defaults and texts.

/// Adds them to the parameters of a dialog, what comes first and what strength, then the shape of
/// the gain: `filter_type`, `feature_size`, `pass_gain`, ..., `power`.
void addTransferParameters(const MeshModel& mesh, RichParameterList& list);

/// Their values.
struct ChosenTransfer {
    spectral::TransferFunctionOptions options;
    double featureSize = 0.0;  ///< Length units; of points, that in their middle.
};

/// @param mesh  what sizes are relative to.
/// @throws spectral::InvalidOption  when an enumeration has none of its values, or the transfer
///                                  function of the user a mistake.
ChosenTransfer chosenTransfer(const RichParameterList& parameters, const MeshMatrices& mesh);

/// Those that are not at their defaults and have no effect on the others, as warnings that say what
/// they would need.
std::vector<std::string> unusedTransferParameters(const RichParameterList& parameters);

/// The warning that a parameter has no effect; none where it has, or is at its default.
/// @param condition  when it has none: "without filter_type = custom".
void warnIfUnused(bool isChanged, bool isUsed, const char* name, const char* condition,
                  std::vector<std::string>& warnings);

/// The name of a filter type among the choices of `filter_type`.
std::string nameOf(spectral::FilterType type);
