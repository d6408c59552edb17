#pragma once

#include <QVariant>
#include <map>
#include <string>
#include <vector>

#include "core/mesh/surface.h"

// What every filter that moves or changes vertices reports of the surface.

/// Entries of the report that pymeshlab returns.
void addSurfaceCounts(const spectral::SurfaceCounts& counts,
                      std::map<std::string, QVariant>& report);

/// A part of a line for the log: "surface: 2 components, 5 boundary vertices fixed".
/// @param fixed  what stays where it is, such as "boundary vertices fixed".
std::string surfaceTold(const spectral::SurfaceCounts& counts,
                        const char* fixed = "boundary vertices fixed");

/// A line for the log: "volume: 2.1 -> 2", or that there is none.
std::string volumeTold(bool hasVolume, double before, double after);

/// Whether every vertex of a surface of a mesh of n vertices must stay where it is.
bool isAllFixed(const spectral::SurfaceCounts& counts, Eigen::Index n);

/// What may tear the surface apart, and what to do about it.
std::vector<std::string> surfaceWarnings(const spectral::SurfaceCounts& counts);
