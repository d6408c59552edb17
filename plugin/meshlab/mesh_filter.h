#pragma once

#include <common/ml_document/mesh_document.h>
#include <common/plugins/interfaces/filter_plugin.h>

#include <functional>
#include <memory>
#include <optional>
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

/// The name of a layer as MeshLab lists it: that of its file without the ending.
QString nameOf(const MeshModel& mesh);

/// Whether a filter may move vertices.
inline bool movesVertices(const MeshFilter& filter) {
    return (filter.changes & MeshModel::MM_VERTCOORD) != 0;
}

/// Mask of what MeshLab must draw anew after a run: what it has written, and where it leaves the
/// vertices alone, these, too, since the preview before may have moved them.
int changedBy(const MeshFilter& filter, const spectral::FilterOutput& output, bool isColored);

/// A run from whose output other values of the parameter `choice` choose.
struct KeptRun {
    const spectral::Filter* filter = nullptr;  ///< Null: there is none.
    spectral::Vertices V;
    spectral::Faces F;
    spectral::Values given;  ///< Without `choice`.
    spectral::FilterOutput output;
    const spectral::Filter* previewed = nullptr;  ///< Whose previews have left `bands`.
    std::shared_ptr<void> bands;
};

/// How a filter is run.
struct RunOptions {
    bool isPreview = false;  ///< A draft will do.
    /// Of a preview: values that were chosen since it began; none: those given.
    std::function<std::optional<spectral::Values>()> newer;
    bool isColored = false;  ///< Whether vertices that move are coloured by how far they do.
    MeshDocument* layers = nullptr;  ///< Where to keep the mesh as it was; null: nowhere.
    KeptRun* kept = nullptr;  ///< What a dialog keeps: the run before, whose output is used if only
                              ///< the choice differs; then this one. Null: nothing is kept.
};

/// Reads a mesh, applies a filter, and writes the result; throws only while the mesh is unchanged.
///
/// @throws spectral::Error, MLException
spectral::FilterOutput applyTo(MeshModel& mesh, const MeshFilter& filter,
                               const spectral::Values& given, const RunOptions& options,
                               const spectral::Progress& progress);
