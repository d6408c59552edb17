#pragma once

#include <QtGlobal>
#include <optional>

#include "core/contract/filter.h"

// pymeshlab has no other way to set the coordinates of a mesh. Python computes, with everything
// that a filter script cannot hold, such as a function for the gain; the plugin writes.

/// Hands a result over to the next filter in this thread, which writes it and computes nothing.
///
/// @param n        number of vertices; 0 takes back what was handed over.
/// @param V        n x 3 positions, row by row, or null: no vertex moves.
/// @param details  n x 3, or null.
/// @param values   n, or null.
/// @param text     the report as lines for the log.
extern "C" Q_DECL_EXPORT void meshlab_spectral_give(int n, const double* V, const double* details,
                                                    const double* values, const char* text);

/// What was handed over in this thread, once.
std::optional<spectral::FilterOutput> takeGivenOutput();
