#pragma once

#include <string>
#include <vector>

#include "core/contract/report.h"
#include "core/contract/warning.h"
#include "core/mesh/measures.h"
#include "core/mesh/surface.h"

namespace spectral {

// What filters that move or change vertices report about the surface.

/// Entries of the counts.
template <class Result>
Entries<Result> surfaceEntries() {
    return {
        {"components", "number of connected components of the surface", &Result::components},
        {"unreferenced_vertices", "number of vertices without faces, unchanged",
         &Result::unreferencedVertices},
        {"joined_vertices", "number of vertices at seams that were joined to another",
         &Result::joinedVertices},
        {"fixed_vertices", "number of vertices on a fixed boundary or a crease, unchanged",
         &Result::fixedVertices},
    };
}

/// Entries of displacements, volumes and counts, of filters that move vertices.
template <class Result>
Entries<Result> movementEntries() {
    return joined<Result>({
        {{"rms_displacement", "root mean square of the displacements, length",
          &Result::rmsDisplacement},
         {"max_displacement", "largest displacement of a vertex, length", &Result::maxDisplacement},
         {"limited_share", "share of the surface, 0 to 1, at which the bound on it was reached",
          &Result::limitedShare},
         {"has_volume", "whether the surface is closed and consistently oriented",
          &Result::hasVolume},
         {"volume_before", "signed volume of the surface, length³; meaningless unless `has_volume`",
          &Result::volumeBefore},
         {"volume_after",
          "signed volume of the filtered surface, length³; meaningless unless `has_volume`",
          &Result::volumeAfter},
         {"folded_faces",
          "number of faces that have folded over: turned against the input and the faces around "
          "them, of more than 1 % of the mean area",
          [](const Result& r) -> Value { return static_cast<int>(r.foldedFaces); }},
         {"preserved_volumes", "number of closed components whose volume was preserved",
          [](const Result& r) -> Value { return r.volumes.preserved; }}},
        surfaceEntries<Result>(),
    });
}

/// The first line of a log, for everybody: "Smoothed: 0.4 on average, 3.1 at most (0.1 % and 0.8 %
/// of the diagonal)".
std::string movementText(const std::string& done, double mean, double most, double diagonal);

/// What follows a deed: "; bound reached at 3 % of the surface", or nothing.
/// @param share  of the surface, 0 to 1.
std::string limitText(double share);

/// Part of a log line: "surface: 2 components, 5 boundary vertices fixed".
/// @param fixed  what is fixed, e.g. "boundary vertices fixed".
std::string surfaceText(const SurfaceCounts& counts, const char* fixed = "boundary vertices fixed");

/// A log line: "volume: 2.1 -> 2", or that there is none.
std::string volumeText(bool hasVolume, double before, double after);

/// "only the selection: 44 of 642 vertices": other filters leave selections behind unnoticed. Empty
/// if everything is filtered.
/// @param selected  one value per vertex, or empty.
std::string selectionText(const std::vector<bool>& selected);

/// Whether every vertex of a surface of a mesh of n vertices must stay as it is.
bool isAllFixed(const SurfaceCounts& counts, Index n);

/// Warns that the boundary fixes every vertex.
/// @param verb  what no vertex can do: "move" or "change".
Warning allFixedWarning(const std::string& verb);

/// Warns of what may tear the surface apart, and says what to do about it.
Warnings surfaceWarnings(const SurfaceCounts& counts);

/// Warns of vertices without faces that enlarge the diagonal by more than 1 %, and of a value that
/// may stand for missing data: percentages then do not mean what they seem to.
Warnings percentageWarnings(const MeshLengths& mesh);

/// Warns where opposite boundaries of a periodic cell matched and do not any more.
Warnings periodicWarnings(const Vertices& before, const Faces& F, const Vertices& after);

}  // namespace spectral
