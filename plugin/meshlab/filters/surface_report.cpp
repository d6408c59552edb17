#include "meshlab/filters/surface_report.h"

#include <iomanip>
#include <sstream>
#include <utility>

void addSurfaceCounts(const spectral::SurfaceCounts& counts,
                      std::map<std::string, QVariant>& report) {
    report["components"] = counts.components;
    report["unreferenced_vertices"] = counts.unreferencedVertices;
    report["joined_vertices"] = counts.joinedVertices;
    report["fixed_vertices"] = counts.fixedVertices;
}

std::string surfaceText(const spectral::SurfaceCounts& counts, const char* fixed) {
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

bool isAllFixed(const spectral::SurfaceCounts& counts, Eigen::Index n) {
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

std::vector<std::string> surfaceWarnings(const spectral::SurfaceCounts& counts) {
    if (counts.nearlyJoined == 0) return {};
    return {std::to_string(counts.nearlyJoined) +
            " vertices on the boundary are within round-off of others, but not at the same point: "
            "the surface may tear there. Apply 'Merge Close Vertices' first"};
}
