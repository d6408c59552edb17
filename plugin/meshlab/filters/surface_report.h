#pragma once

#include <QVariant>
#include <map>
#include <string>
#include <vector>

#include "core/mesh/surface.h"

// What filters that move or change vertices report about the surface.

/// Adds the counts to the report that pymeshlab returns.
void addSurfaceCounts(const spectral::SurfaceCounts& counts,
                      std::map<std::string, QVariant>& report);

/// Adds displacements, volumes and counts, for filters that move vertices.
template <class Result>
void addMovement(const Result& result, std::map<std::string, QVariant>& report) {
    report["rms_displacement"] = result.rmsDisplacement;
    report["max_displacement"] = result.maxDisplacement;
    report["has_volume"] = result.hasVolume;
    report["volume_before"] = result.volumeBefore;
    report["volume_after"] = result.volumeAfter;
    report["preserved_volumes"] = result.volumes.preserved;
    addSurfaceCounts(result, report);
}

/// Part of a log line: "surface: 2 components, 5 boundary vertices fixed".
/// @param fixed  what is fixed, e.g. "boundary vertices fixed".
std::string surfaceText(const spectral::SurfaceCounts& counts,
                        const char* fixed = "boundary vertices fixed");

/// A log line: "volume: 2.1 -> 2", or that there is none.
std::string volumeText(bool hasVolume, double before, double after);

/// Whether every vertex of a surface of a mesh of n vertices must stay as it is.
bool isAllFixed(const spectral::SurfaceCounts& counts, Eigen::Index n);

/// Warns that the boundary fixes every vertex.
/// @param verb  what no vertex can do: "move" or "change".
std::string allFixedWarning(const std::string& verb);

/// Appends warnings.
void append(std::vector<std::string> more, std::vector<std::string>& warnings);

/// Warns of what may tear the surface apart, and says what to do about it.
std::vector<std::string> surfaceWarnings(const spectral::SurfaceCounts& counts);
