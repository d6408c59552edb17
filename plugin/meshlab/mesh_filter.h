#pragma once

#include <common/plugins/interfaces/filter_plugin.h>

#include <string>
#include <vector>

#include "core/contract/filter.h"
#include "meshlab/mesh_conversion.h"

/// Which values at the vertices a filter reads.
enum class MeshValues { None, Quality, Colors };

/// What MeshLab needs to know about a filter besides what every host does.
struct MeshFilter {
    const spectral::Filter& contract;
    FilterPlugin::FilterClass category;
    int changes;        ///< Mask of what the filter writes.
    MeshValues values;  ///< Needed; a vertex quality is read in any case.

    /// Writes a result to the mesh; may add to its text.
    void (*write)(const MeshMatrices& input, const spectral::Values& given,
                  spectral::FilterOutput& output, MeshModel& mesh);
};

/// All filters; their positions are MeshLab's action ids.
std::vector<MeshFilter> allMeshFilters();

/// Reads a mesh, applies a filter, and writes the result; throws only while the mesh is unchanged.
/// @throws spectral::Error, MLException
spectral::FilterOutput applyTo(MeshModel& mesh, const MeshFilter& filter,
                               const spectral::Values& given, const spectral::Progress& progress);
