#include "core/contract/surface_report.h"

#include <algorithm>
#include <cstddef>
#include <iomanip>
#include <sstream>
#include <utility>

namespace spectral {

std::string movementText(const std::string& done, double mean, double most, double diagonal) {
    std::ostringstream text;
    text << done << ": " << std::setprecision(2) << mean << " on average, " << most << " at most ("
         << 100.0 * mean / diagonal << " % and " << 100.0 * most / diagonal
         << " % of the diagonal)";
    return text.str();
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
    std::ostringstream text;
    text << std::setprecision(6) << "volume: " << before << " -> " << after;
    return text.str();
}

bool isAllFixed(const SurfaceCounts& counts, Index n) {
    return counts.fixedVertices > 0 &&
           counts.fixedVertices + counts.joinedVertices + counts.unreferencedVertices == n;
}

std::string allFixedWarning(const std::string& verb) {
    return "nothing can " + verb +
           ": every vertex lies on the boundary, which is fixed. Choose boundary = free; if the "
           "triangles are not connected, apply 'Merge Close Vertices' first";
}

void append(std::vector<std::string> more, std::vector<std::string>& warnings) {
    for (std::string& warning : more) warnings.push_back(std::move(warning));
}

std::vector<std::string> surfaceWarnings(const SurfaceCounts& counts) {
    if (counts.nearlyJoined == 0) return {};
    return {std::to_string(counts.nearlyJoined) +
            " vertices on the boundary are within round-off of others, but not at the same point: "
            "the surface may tear there. Apply 'Merge Close Vertices' first"};
}

std::string selectionText(const std::vector<bool>& selected) {
    const auto count = std::count(selected.begin(), selected.end(), true);
    const auto all = static_cast<std::ptrdiff_t>(selected.size());
    if (count == all) return {};
    return "only the selection: " + std::to_string(count) + " of " + std::to_string(all) +
           " vertices";
}

std::vector<std::string> percentageWarnings(const MeshLengths& mesh) {
    constexpr double kNoticeable = 1.01;
    if (!(mesh.diagonal > kNoticeable * mesh.surfaceDiagonal)) return {};
    const bool isOne = mesh.outside == 1;
    std::ostringstream text;
    text << std::setprecision(3) << mesh.outside
         << (isOne ? " vertex without faces enlarges" : " vertices without faces enlarge")
         << " the diagonal of the bounding box from " << mesh.surfaceDiagonal << " to "
         << mesh.diagonal
         << ": percentages refer to the larger one, defaults to the smaller. Apply 'Remove "
            "Unreferenced Vertices' first";
    return {text.str()};
}

}  // namespace spectral
