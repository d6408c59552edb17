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
    int changes;        ///< Mask of what the filter may write.
    MeshValues values;  ///< Needed; a vertex quality is read in any case.

    /// Writes a result to the mesh; may add to its text.
    void (*write)(const MeshMatrices& input, const spectral::Values& given,
                  spectral::FilterOutput& output, MeshModel& mesh);
};

/// All filters; their positions are MeshLab's action ids.
std::vector<MeshFilter> allMeshFilters();

/// Mask of what a run has written.
int changedBy(const MeshFilter& filter, const spectral::FilterOutput& output);

/// A run from whose output other values of the parameter `choice` choose.
struct KeptRun {
    const spectral::Filter* filter = nullptr;  ///< Null: there is none.
    spectral::Vertices V;
    spectral::Faces F;
    spectral::Values given;  ///< Without `choice`.
    spectral::FilterOutput output;
};

/// Reads a mesh, applies a filter, and writes the result; throws only while the mesh is unchanged.
///
/// @param kept  the run before, whose output is used if only the choice differs; then this one.
/// Null:
///              nothing is kept.
/// @throws spectral::Error, MLException
spectral::FilterOutput applyTo(MeshModel& mesh, const MeshFilter& filter,
                               const spectral::Values& given, KeptRun* kept,
                               const spectral::Progress& progress);
