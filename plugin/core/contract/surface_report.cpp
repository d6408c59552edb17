#include "core/contract/surface_report.h"

#include <algorithm>
#include <cstddef>
#include <iomanip>
#include <sstream>
#include <utility>

#include "core/contract/number_text.h"
#include "core/mesh/periodic.h"

namespace spectral {

std::string movementText(const std::string& done, double mean, double most, double diagonal) {
    std::ostringstream text;
    text << done << ": " << std::setprecision(2) << mean << " on average, " << most << " at most ("
         << 100.0 * mean / diagonal << " % and " << 100.0 * most / diagonal
         << " % of the diagonal)";
    return text.str();
}

std::string limitText(double share) {
    if (share == 0.0) return "";
    return "; bound reached at " + percentOf(share) + " of the surface";
}

std::string surfaceText(const SurfaceCounts& counts, const char* fixed) {
    std::string text = "surface: " + std::to_string(counts.components) +
                       (counts.components == 1 ? " component" : " components");
    const auto add = [&](int count, const char* what) {
        if (count > 0) text += ", " + std::to_string(count) + " " + what;
    };
    add(counts.joinedVertices, "vertices at seams joined to others");
    add(counts.unreferencedVertices, "unreferenced vertices unchanged");
    add(counts.fixedVertices, fixed);
    return text;
}

std::string volumeText(bool hasVolume, double before, double after) {
    if (!hasVolume) return "volume: none, as the surface is open or not consistently oriented";
    return "volume: " + numberText(before, 6) + " -> " + numberText(after, 6);
}

bool isAllFixed(const SurfaceCounts& counts, Index n) {
    return counts.fixedVertices > 0 &&
           counts.fixedVertices + counts.joinedVertices + counts.unreferencedVertices == n;
}

Warning allFixedWarning(const std::string& verb) {
    return {WarningCode::AllFixed,
            "nothing can " + verb +
                ": every vertex lies on the boundary, which is fixed. Choose |boundary = free|; if "
                "the triangles are not connected, {apply 'Merge Close Vertices'|merge close "
                "vertices} first"};
}

Warnings surfaceWarnings(const SurfaceCounts& counts) {
    Warnings warnings;
    if (counts.nearlyJoined > 0)
        warnings.push_back(
            {WarningCode::NearlyJoined,
             std::to_string(counts.nearlyJoined) +
                 " vertices on the boundary are within round-off of others, but not at the same "
                 "point: the surface may tear there. {Apply 'Merge Close Vertices'|Merge close "
                 "vertices} first"});
    if (counts.flatComponents > 0)
        warnings.push_back(
            {WarningCode::FlatComponents,
             std::to_string(counts.flatComponents) +
                 (counts.flatComponents == 1 ? " component" : " components") +
                 " without area, such as a triangle of three equal points, ignored"});
    return warnings;
}

Warnings periodicWarnings(const Vertices& before, const Faces& F, const Vertices& after) {
    constexpr double kRoundOff = 1e-6;  // of the diagonal
    const auto pairs = periodicPairs(before, F);
    const double mismatch = largestMismatch(pairs, before, after);
    if (!(mismatch > kRoundOff * boundingBoxDiagonal(before))) return {};
    return {{WarningCode::PeriodicCell,
             std::to_string(pairs.size()) +
                 " pairs of vertices on opposite sides matched by a translation, as those of a "
                 "periodic cell, and are now apart by up to " +
                 numberText(mismatch, 3) +
                 ": choose |boundary = fixed|, or filter 3 x 3 x 3 copies and keep the one in the "
                 "middle"}};
}

std::string selectionText(const std::vector<bool>& selected) {
    const auto count = std::count(selected.begin(), selected.end(), true);
    const auto all = static_cast<std::ptrdiff_t>(selected.size());
    if (count == all) return {};
    return "only the selection: " + std::to_string(count) + " of " + std::to_string(all) +
           " vertices";
}

Warnings percentageWarnings(const MeshLengths& mesh) {
    constexpr double kNoticeable = 1.01;
    Warnings warnings;
    std::ostringstream text;
    text << std::setprecision(3);
    if (mesh.filler.vertices == 0 && mesh.diagonal > kNoticeable * mesh.surfaceDiagonal) {
        if (mesh.outside == 0)  // a tile does not see them
            text << "vertices without faces, or for missing data, enlarge";
        else
            text << mesh.outside
                 << (mesh.outside == 1 ? " vertex without faces enlarges"
                                       : " vertices without faces enlarge");
        text << " the diagonal of the bounding box from " << mesh.surfaceDiagonal << " to "
             << mesh.diagonal
             << ": percentages refer to the larger one, defaults to the smaller. {Apply 'Remove "
                "Unreferenced Vertices'|Remove them} first";
        warnings.push_back({WarningCode::FarVertices, text.str()});
        text.str({});
    }
    if (const MeshLengths::Filler& filler = mesh.filler; filler.vertices > 0) {
        const char axis = "xyz"[filler.axis];
        text << std::setprecision(9) << filler.vertices << " vertices have " << axis << " = "
             << filler.value
             << ", far from all others: defaults leave them out. If that stands for missing "
             << "data, select the rest (|where = " << axis << (filler.isLowest ? " > " : " < ")
             << filler.value << "|)";
        warnings.push_back({WarningCode::MissingData, text.str()});
    }
    return warnings;
}

}  // namespace spectral
