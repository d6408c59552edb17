#include "meshlab/mesh_conversion.h"

#include <common/mlexception.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/mesh/normals.h"
#include "core/support/threads.h"

namespace {

Eigen::RowVector3d positionOf(const CVertexO& vertex) {
    return {vertex.cP()[0], vertex.cP()[1], vertex.cP()[2]};
}

/// Whether the mesh still equals the input; compared in place, to avoid another copy.
bool isUnchanged(const MeshMatrices& input, const CMeshO& mesh) {
    if (mesh.vn != input.V.rows() || mesh.fn != input.F.rows()) return false;
    Eigen::Index i = 0, t = 0;
    for (std::size_t v = 0; v < mesh.vert.size(); ++v) {
        if (mesh.vert[v].IsD()) continue;
        if (input.vertexIndex[i] != v || input.V.row(i) != positionOf(mesh.vert[v])) return false;
        ++i;
    }
    for (const CFaceO& face : mesh.face) {
        if (face.IsD()) continue;
        for (int c = 0; c < 3; ++c)
            if (input.vertexIndex[input.F(t, c)] != vcg::tri::Index(mesh, face.cV(c))) return false;
        ++t;
    }
    return true;
}

// Faster than MeshModel::updateBoxAndNormals, which takes a noticeable share of a filter's time.
void setNormals(const MeshMatrices& input, const spectral::Vertices& V, CMeshO& mesh) {
    const spectral::ThreadTeam team;
    const auto normals = spectral::angleWeightedNormals<Scalarm>(V, input.F);
    const auto toPoint = [](const auto& row) { return Point3m(row[0], row[1], row[2]); };
    Eigen::Index t = 0;
    for (CFaceO& face : mesh.face) {
        if (face.IsD()) continue;
        face.N() = toPoint(normals.faces.row(t));
        for (int c = 0; c < 3; ++c) face.V(c)->N() = toPoint(normals.vertices.row(input.F(t, c)));
        ++t;
    }
}

}  // namespace

MeshMatrices toMatrices(const CMeshO& mesh) {
    MeshMatrices matrices;
    matrices.vertexIndex.reserve(mesh.vn);
    std::vector<int> row(mesh.vert.size(), -1);
    for (std::size_t i = 0; i < mesh.vert.size(); ++i) {
        if (mesh.vert[i].IsD()) continue;
        row[i] = static_cast<int>(matrices.vertexIndex.size());
        matrices.vertexIndex.push_back(i);
    }
    matrices.V.resize(mesh.vn, 3);
    for (int i = 0; i < mesh.vn; ++i)
        matrices.V.row(i) = positionOf(mesh.vert[matrices.vertexIndex[i]]);

    matrices.F.resize(mesh.fn, 3);
    int t = 0;
    for (const CFaceO& face : mesh.face) {
        if (face.IsD()) continue;
        for (int c = 0; c < 3; ++c) matrices.F(t, c) = row[vcg::tri::Index(mesh, face.cV(c))];
        ++t;
    }
    return matrices;
}

std::vector<bool> selectedVertices(const CMeshO& mesh, const MeshMatrices& matrices) {
    std::vector<bool> selected;
    for (const std::size_t i : matrices.vertexIndex) selected.push_back(mesh.vert[i].IsS());
    Eigen::Index t = 0;
    for (const CFaceO& face : mesh.face) {
        if (face.IsD()) continue;
        if (face.IsS())
            for (int c = 0; c < 3; ++c) selected[matrices.F(t, c)] = true;
        ++t;
    }
    return selected;
}

bool hasSelectedFaces(const CMeshO& mesh) {
    return std::any_of(mesh.face.begin(), mesh.face.end(),
                       [](const CFaceO& face) { return !face.IsD() && face.IsS(); });
}

Eigen::VectorXd vertexQuality(const CMeshO& mesh, const MeshMatrices& matrices) {
    Eigen::VectorXd quality(matrices.V.rows());
    for (Eigen::Index i = 0; i < quality.size(); ++i)
        quality[i] = mesh.vert[matrices.vertexIndex[i]].cQ();
    return quality;
}

Eigen::MatrixXd vertexColors(const CMeshO& mesh, const MeshMatrices& matrices) {
    Eigen::MatrixXd colors(matrices.V.rows(), 3);
    for (Eigen::Index i = 0; i < colors.rows(); ++i)
        for (int c = 0; c < 3; ++c) colors(i, c) = mesh.vert[matrices.vertexIndex[i]].cC()[c];
    return colors;
}

void checkExtent(const CMeshO& mesh) {
    // For the bounding box diagonal, MeshLab squares coordinates in its own precision; lengths such
    // as a tolerance of a thousandth of it are stored in single precision.
    constexpr bool isFloat = sizeof(Scalarm) == sizeof(float);
    constexpr double largest = isFloat ? 1e18 : 1e37, smallest = isFloat ? 1e-18 : 1e-33;
    // 'Transform: Scale, Normalize' leaves some such meshes unchanged, or turns them into NaN.
    const char* const remedy =
        "scale the mesh first, e.g. with 'Per Vertex Geometric Function', x * 1e%1";
    Eigen::AlignedBox3d box;
    for (const CVertexO& vertex : mesh.vert) {
        if (vertex.IsD()) continue;
        const Eigen::Vector3d p = positionOf(vertex);
        if (!p.allFinite()) continue;  // reported by the core
        if (p.cwiseAbs().maxCoeff() > largest)
            throw MLException(QString("vertex %1 has a coordinate of %2, and the largest that can "
                                      "be filtered is %3: %4")
                                  .arg(vcg::tri::Index(mesh, vertex))
                                  .arg(p.maxCoeff() > largest ? p.maxCoeff() : p.minCoeff())
                                  .arg(largest)
                                  .arg(QString(remedy).arg(-30)));
        box.extend(p);
    }
    const double extent = box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
    if (extent > 0.0 && extent < smallest)
        throw MLException(QString("the mesh is only %1 wide, and the smallest that can be filtered "
                                  "is %2: %3")
                              .arg(extent)
                              .arg(smallest)
                              .arg(QString(remedy).arg("+30")));
}

void reportWriting(const MeshMatrices& input, const CMeshO& mesh,
                   const spectral::Progress& progress) {
    progress.report(1.0, "writing the mesh");
    if (!isUnchanged(input, mesh))
        throw MLException(
            "the mesh was edited while the filter was running, and has not been filtered: "
            "apply the filter again");
}

void setPositions(const MeshMatrices& input, const spectral::Vertices& V, MeshModel& mesh) {
    for (Eigen::Index i = 0; i < V.rows(); ++i)
        for (int c = 0; c < 3; ++c)
            mesh.cm.vert[input.vertexIndex[i]].P()[c] = static_cast<Scalarm>(V(i, c));
    vcg::tri::UpdateBounding<CMeshO>::Box(mesh.cm);
    setNormals(input, V, mesh.cm);
}

void setQuality(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                MeshModel& mesh) {
    mesh.updateDataMask(MeshModel::MM_VERTQUALITY);
    for (std::size_t i = 0; i < vertexIndex.size(); ++i)
        mesh.cm.vert[vertexIndex[i]].Q() =
            static_cast<Scalarm>(values[static_cast<Eigen::Index>(i)]);
}

Eigen::VectorXd alongNormals(const MeshMatrices& matrices, const spectral::Vertices& vectors,
                             const CMeshO& mesh) {
    Eigen::VectorXd outward = Eigen::VectorXd::Zero(vectors.rows());
    for (Eigen::Index i = 0; i < vectors.rows(); ++i) {
        const Point3m& n = mesh.vert[matrices.vertexIndex[i]].cN();
        const Eigen::RowVector3d normal(n[0], n[1], n[2]);
        // MeshLab's normals need not have unit length, and are zero where there are no faces.
        if (normal.norm() > 0.0) outward[i] = vectors.row(i).dot(normal.normalized());
    }
    return outward;
}

void setVectors(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                const spectral::Vertices& vectors, MeshModel& mesh) {
    using Attributes = vcg::tri::Allocator<CMeshO>;
    Attributes::DeletePerVertexAttribute(mesh.cm, name);
    auto attribute = Attributes::AddPerVertexAttribute<Point3m>(mesh.cm, name);
    for (std::size_t i = 0; i < mesh.cm.vert.size(); ++i) attribute[i] = Point3m(0, 0, 0);
    for (Eigen::Index i = 0; i < vectors.rows(); ++i)
        attribute[vertexIndex[i]] =
            Point3m(static_cast<Scalarm>(vectors(i, 0)), static_cast<Scalarm>(vectors(i, 1)),
                    static_cast<Scalarm>(vectors(i, 2)));
}

void setAttribute(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                  const Eigen::VectorXd& values, MeshModel& mesh) {
    using Attributes = vcg::tri::Allocator<CMeshO>;
    Attributes::DeletePerVertexAttribute(mesh.cm, name);  // names are unique across types
    auto attribute = Attributes::AddPerVertexAttribute<Scalarm>(mesh.cm, name);
    for (std::size_t i = 0; i < mesh.cm.vert.size(); ++i) attribute[i] = 0;
    for (std::size_t i = 0; i < vertexIndex.size(); ++i)
        attribute[vertexIndex[i]] = static_cast<Scalarm>(values[static_cast<Eigen::Index>(i)]);
}

void setAttributes(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                   const Eigen::MatrixXd& values, MeshModel& mesh) {
    Eigen::Index older = values.cols();
    while (vcg::tri::Allocator<CMeshO>::DeletePerVertexAttribute(mesh.cm,
                                                                 name + std::to_string(older)))
        ++older;  // left by a larger basis
    for (Eigen::Index j = 0; j < values.cols(); ++j)
        setAttribute(vertexIndex, name + std::to_string(j), values.col(j), mesh);
}
