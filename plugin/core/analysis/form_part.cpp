#include "core/analysis/form_part.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/mesh/sides.h"
#include "core/mesh/union_find.h"
#include "core/support/errors.h"

namespace spectral {

namespace {

/// Calls work(t, u) for the pairs of triangles that share an edge.
template <class Work>
void forNeighbours(const SidesByEdge& sides, const Work& work) {
    sides.forEachEdge([&](auto first, auto end) {
        for (auto side = first + 1; side < end; ++side) work((side - 1)->face(), side->face());
    });
}

/// Triangles with their normals, and connected pieces about as large as a size.
struct Pieces {
    Vertices normals;  ///< m x 3, of the length of the area.
    Vertices centres;  ///< m x 3.
    std::vector<int> piece;
    SidesByEdge sides;

    Pieces(const Surface& surface, double size) : sides(surface.F) {
        const Vertices& X = surface.X;
        const Faces& F = surface.F;
        normals.resize(F.rows(), 3);
        centres.resize(F.rows(), 3);
        for (Index t = 0; t < F.rows(); ++t) {
            const Eigen::RowVector3d a = X.row(F(t, 0)), b = X.row(F(t, 1)), c = X.row(F(t, 2));
            normals.row(t) = 0.5 * (b - a).cross(c - a);
            centres.row(t) = (a + b + c) / 3.0;
        }
        UnionFind pieces(F.rows());
        const auto cell = [&](Index t) {
            return Eigen::RowVector3d((centres.row(t) / size).array().floor());
        };
        forNeighbours(sides, [&](int t, int u) {
            if (cell(t) == cell(u)) pieces.unite(t, u);
        });
        piece = pieces.roots();
    }
};

/// Areas as seen along the normals of a shape, m: negative from behind.
Eigen::VectorXd facingAreas(const FittedShape& shape, const Pieces& pieces) {
    return shape.distancesOf(pieces.centres).N.cwiseProduct(pieces.normals).rowwise().sum();
}

/// Sums over pieces, at each of their triangles.
Eigen::VectorXd overPieces(const Pieces& pieces, const Eigen::VectorXd& areas) {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(areas.size());
    for (Index t = 0; t < areas.size(); ++t) sums[pieces.piece[t]] += areas[t];
    for (Index t = areas.size(); t-- > 0;) sums[t] = sums[pieces.piece[t]];
    return sums;
}

/// Flips what is so in connected parts of less than an area.
void cleared(const Pieces& pieces, double least, bool value, std::vector<bool>& flags) {
    UnionFind parts(static_cast<Index>(flags.size()));
    forNeighbours(pieces.sides, [&](int t, int u) {
        if (flags[t] == flags[u]) parts.unite(t, u);
    });
    const std::vector<int> part = parts.roots();
    std::vector<double> areas(flags.size(), 0.0);
    for (std::size_t t = 0; t < flags.size(); ++t)
        areas[part[t]] += pieces.normals.row(static_cast<Index>(t)).norm();
    for (std::size_t t = 0; t < flags.size(); ++t)
        if (flags[t] == value && areas[part[t]] < least) flags[t] = !value;
}

/// The least share of its area that a piece of the form shows along the normals: a wall of a
/// cylinder with roughness of a mean slope of 5 shows .2, its caps .0.
constexpr double kFacing = 0.1;

/// Whether each triangle faces along the normals of a shape, as pieces do on the whole.
std::vector<bool> facingFaces(const Pieces& pieces, const Eigen::VectorXd& facing, double size) {
    constexpr double kSliver = 1.0 / 64.0;  // of a piece: too small to tell
    const Eigen::VectorXd shown = overPieces(pieces, facing);
    const Eigen::VectorXd all = overPieces(pieces, pieces.normals.rowwise().norm());
    std::vector<bool> faces(static_cast<std::size_t>(facing.size()));
    for (Index t = 0; t < facing.size(); ++t) faces[t] = shown[t] > kFacing * all[t];
    cleared(pieces, kSliver * size * size, false, faces);
    cleared(pieces, kSliver * size * size, true, faces);
    return faces;
}

/// The share of the facing areas at each vertex that is selected, >= 0.
Eigen::VectorXd vertexWeights(const Surface& surface, const std::vector<bool>& faces,
                              const Eigen::VectorXd& facing, const std::vector<bool>& selected) {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(surface.X.rows());
    for (Index t = 0; t < surface.F.rows(); ++t)
        for (const int i : surface.F.row(t))
            if (faces[t] && selected[i]) weights[i] += facing[t] / 3.0;
    return weights.cwiseMax(0.0);
}

Vertices vertexNormals(const Surface& surface, const Vertices& normals) {
    Vertices N = Vertices::Zero(surface.X.rows(), 3);
    for (Index t = 0; t < surface.F.rows(); ++t)
        for (const int i : surface.F.row(t)) N.row(i) += normals.row(t);
    return N;
}

/// Refuses a surface that has about as much behind as in front.
void checkSide(ShapeKind kind, const Surface& surface, const Eigen::VectorXd& facing,
               const std::vector<bool>& selected) {
    constexpr double kOther = 0.5;  // a block's base is as large as its top, an overhang a tenth
    double front = 0.0, behind = 0.0;
    for (Index t = 0; t < surface.F.rows(); ++t) {
        const auto corners = surface.F.row(t);
        if (!std::all_of(corners.begin(), corners.end(), [&](int i) { return selected[i]; }))
            continue;
        (facing[t] > 0.0 ? front : behind) += std::abs(facing[t]);
    }
    if (behind > kOther * front)
        throw InvalidOption("form = " + std::string(nameOf(kind)) +
                            ": as much of the surface faces backwards as forwards. Select the "
                            "side to measure, such as where nz > 0.5");
}

/// The chosen triangles and their vertices.
Surface partOf(Surface whole, const std::vector<bool>& faces) {
    Faces F(std::count(faces.begin(), faces.end(), true), 3);
    for (Index t = 0, row = 0; t < whole.F.rows(); ++t)
        if (faces[t]) F.row(row++) = whole.F.row(t);
    if (F.rows() == whole.F.rows()) return whole;
    Surface part = surfaceOf(whole.X, F);
    std::vector<Index> rowOf(static_cast<std::size_t>(whole.X.rows()), -1);
    for (Index i = 0; i < part.X.rows(); ++i) {
        const Index of = std::exchange(part.vertex[i], whole.vertex[part.vertex[i]]);
        rowOf[of] = i;
        part.X.row(i) = whole.X.row(of);
    }
    for (const auto& [vertex, row] : whole.copies)
        if (rowOf[row] >= 0) part.copies.push_back({vertex, rowOf[row]});
    return part;
}

}  // namespace

FormPart formPart(ShapeKind kind, Surface surface, const std::vector<bool>& selected, double size) {
    constexpr double kRoundOff = 1e-6;
    constexpr int kMaxRounds = 10;  // without caps a fit is that without them after two or three
    const Pieces pieces(surface, size);
    const Vertices normals = vertexNormals(surface, pieces.normals);
    std::vector<bool> faces(static_cast<std::size_t>(surface.F.rows()), true);
    Eigen::VectorXd facing = pieces.normals.rowwise().norm();
    Eigen::VectorXd weights = vertexWeights(surface, faces, facing, selected);
    FormPart form;
    for (int round = 0; round < kMaxRounds; ++round) {
        form.shape = fitShape(kind, surface.X, normals, weights);
        facing = facingAreas(form.shape, pieces);
        std::vector<bool> next = facingFaces(pieces, facing, size);
        weights = vertexWeights(surface, next, facing, selected);
        if (!(weights.sum() > 0.0))
            throw InvalidOption("form = " + std::string(nameOf(kind)) +
                                ": the surface does not follow it, choose another one");
        const bool isSettled = round > 0 && next == faces;
        faces = std::move(next);
        if (isSettled) break;
    }
    checkSide(kind, surface, facing, selected);
    const Eigen::VectorXd d = form.shape.distancesOf(surface.X).d;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (Index i = 0; i < d.size(); ++i) {
        if (weights[i] == 0.0) continue;
        low = std::min(low, d[i]);
        high = std::max(high, d[i]);
    }
    const double margin = std::max(high - low, kRoundOff * size);
    for (Index t = 0; t < surface.F.rows(); ++t)
        for (const int i : surface.F.row(t))
            faces[t] = faces[t] && d[i] >= low - margin && d[i] <= high + margin;
    std::vector<bool> isOn(selected.size(), false);
    for (Index t = 0; t < surface.F.rows(); ++t)
        for (const int i : surface.F.row(t)) isOn[i] = isOn[i] || faces[t];
    for (std::size_t i = 0; i < isOn.size(); ++i) form.elsewhere += selected[i] && !isOn[i];
    form.surface = partOf(std::move(surface), faces);
    form.heights = form.shape.distancesOf(form.surface.X);
    return form;
}

}  // namespace spectral
