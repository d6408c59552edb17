#include "meshlab/filters/common_parameters.h"

#include <common/parameters/rich_parameters.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <sstream>

#include "core/mesh/measures.h"
#include "core/support/errors.h"

namespace {

// In the order of the core's enumerations.
QStringList laplacians() { return {"intrinsic delaunay", "cotangent", "uniform"}; }
}  // namespace

QStringList boundaries() { return {"free", "fixed"}; }

int choice(const RichParameterList& parameters, const char* name, const QStringList& choices) {
    const int value = parameters.getEnum(name);
    if (value >= 0 && value < choices.size()) return value;
    QStringList numbered;
    for (int i = 0; i < choices.size(); ++i)
        numbered.push_back(QString("%1 (%2)").arg(i).arg(choices[i]));
    throw spectral::InvalidOption(std::string(name) + " = " + std::to_string(value) + ": choose " +
                                  numbered.join(", ").toStdString());
}

double meanEdge(const MeshModel& mesh) {
    const MeshMatrices matrices = toMatrices(mesh.cm);
    return spectral::meanEdgeLength(matrices.V, matrices.F);
}

double surfaceDiagonal(const MeshModel& mesh) {
    Box3m box;
    for (const CFaceO& face : mesh.cm.face)
        if (!face.IsD())
            for (int c = 0; c < 3; ++c) box.Add(face.cP(c));
    return box.IsNull() ? mesh.cm.bbox.Diag() : box.Diag();
}

double defaultTolerance(const MeshModel& mesh) {
    constexpr double kHalfAPixel = 0.0005;  // of a mesh shown 1,000 pixels wide
    return kHalfAPixel * surfaceDiagonal(mesh);
}

std::vector<std::string> percentageWarnings(const MeshMatrices& input) {
    constexpr double kNoticeable = 1.01;
    const spectral::Diagonals diagonals = spectral::diagonalsOf(input.V, input.F);
    if (!(diagonals.all > kNoticeable * diagonals.surface)) return {};
    const bool isOne = diagonals.outside == 1;
    std::ostringstream text;
    text << std::setprecision(3) << diagonals.outside
         << (isOne ? " vertex without faces enlarges" : " vertices without faces enlarge")
         << " the diagonal of the bounding box from " << diagonals.surface << " to "
         << diagonals.all
         << ": percentages refer to the larger one, defaults to the smaller. Apply 'Remove "
            "Unreferenced Vertices' first";
    return {text.str()};
}

QString meanEdgeText(double meanEdge) {
    if (meanEdge == 0.0) return {};
    return QString(" The mean edge length of this mesh is %1.").arg(meanEdge, 0, 'g', 3);
}

RichPercentage featureSizeParameter(const MeshModel& mesh, const QString& help) {
    const Scalarm diagonal = mesh.cm.bbox.Diag();
    const double edge = meanEdge(mesh);
    return {"feature_size",
            static_cast<Scalarm>(spectral::defaultFeatureSize(edge, surfaceDiagonal(mesh))),
            0,
            diagonal,
            "Feature size",
            help + meanEdgeText(edge)};
}

double featureSize(const RichParameterList& parameters) {
    return parameters.getAbsPerc("feature_size");
}

bool isDefaultFeatureSize(const RichParameterList& parameters, const MeshModel& mesh,
                          const MeshMatrices& matrices) {
    // A field of MeshLab's dialog rounds its number.
    constexpr double kRounding = 1e-4;
    const double size = spectral::defaultFeatureSize(
        spectral::meanEdgeLength(matrices.V, matrices.F), surfaceDiagonal(mesh));
    return std::abs(featureSize(parameters) - size) <= kRounding * size;
}

RichBool selectedParameter(const MeshModel& mesh, const QString& width) {
    const bool isAnySelected = hasSelectedFaces(mesh.cm);
    return {"selected", isAnySelected, "Only the selection",
            QString("Filter only the selected faces and vertices. Around them the filter fades out "
                    "within %1, so that no crease is left; everything beyond is unchanged.")
                .arg(width),
            !isAnySelected};
}

std::vector<bool> chosenVertices(const RichParameterList& parameters, const MeshModel& mesh,
                                 const MeshMatrices& matrices) {
    if (!parameters.getBool("selected")) return {};
    return selectedVertices(mesh.cm, matrices);
}

std::string selectionText(const std::vector<bool>& selected) {
    const auto count = std::count(selected.begin(), selected.end(), true);
    const auto all = static_cast<std::ptrdiff_t>(selected.size());
    if (count == all) return {};
    return "only the selection: " + std::to_string(count) + " of " + std::to_string(all) +
           " vertices";
}

RichEnum laplacianParameter() {
    return {"laplacian",
            static_cast<int>(spectral::LaplacianKind::IntrinsicDelaunay),
            laplacians(),
            "Laplacian",
            "How the frequencies of the surface are measured. <b>intrinsic delaunay</b> works on "
            "any triangles, including slivers, holes, duplicate or intersecting sheets, and is "
            "stable for strong filters. <b>cotangent</b> is the formula of the paper; no triangle "
            "may have zero area. <b>uniform</b> uses the connectivity only, as if the vertices "
            "were evenly spaced: for noise that differs from vertex to vertex.",
            true};
}

spectral::LaplacianKind laplacianKind(const RichParameterList& parameters) {
    return static_cast<spectral::LaplacianKind>(choice(parameters, "laplacian", laplacians()));
}

RichEnum boundaryParameter(const QString& help) {
    return {"boundary",
            static_cast<int>(spectral::Boundary::Free),
            boundaries(),
            "Boundary",
            "The boundary of an open surface, holes included. " + help,
            true};
}

spectral::Boundary boundaryCondition(const RichParameterList& parameters) {
    return static_cast<spectral::Boundary>(choice(parameters, "boundary", boundaries()));
}
