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

/// Entries of a filter that moves vertices: how far, volumes, and the surface's.
template <class Result>
void addMovement(const Result& result, std::map<std::string, QVariant>& report) {
    report["rms_displacement"] = result.rmsDisplacement;
    report["max_displacement"] = result.maxDisplacement;
    report["volume_before"] = result.volumeBefore;
    report["volume_after"] = result.volumeAfter;
    report["preserved_volumes"] = result.volumes.preserved;
    addSurfaceCounts(result, report);
}

/// A part of a line for the log: "surface: 2 components, 5 boundary vertices fixed".
/// @param fixed  what stays where it is, such as "boundary vertices fixed".
std::string surfaceTold(const spectral::SurfaceCounts& counts,
                        const char* fixed = "boundary vertices fixed");

/// A line for the log: "volume: 2.1 -> 2", or that there is none.
std::string volumeTold(bool hasVolume, double before, double after);

/// Whether every vertex of a surface of a mesh of n vertices must stay as it is.
bool isAllFixed(const spectral::SurfaceCounts& counts, Eigen::Index n);

/// A warning of a boundary that fixes every vertex.
/// @param verb  what none can do: "move" or "change".
std::string allFixedWarning(const std::string& verb);

/// Appends warnings.
void append(std::vector<std::string> more, std::vector<std::string>& warnings);

/// What may tear the surface apart, and what to do about it.
std::vector<std::string> surfaceWarnings(const spectral::SurfaceCounts& counts);
