#include "meshlab/mesh_conversion.h"

#include <common/mlexception.h>

#include <cmath>

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
    for (int i = 0; i < mesh.vn; ++i) {
        const Point3m& p = mesh.vert[matrices.vertexIndex[i]].cP();
        matrices.V.row(i) << p[0], p[1], p[2];
    }

    matrices.F.resize(mesh.fn, 3);
    int t = 0;
    for (const CFaceO& face : mesh.face) {
        if (face.IsD()) continue;
        for (int c = 0; c < 3; ++c) matrices.F(t, c) = row[vcg::tri::Index(mesh, face.cV(c))];
        ++t;
    }
    return matrices;
}

void checkExtent(const CMeshO& mesh) {
    // MeshLab squares coordinates in its own precision for the diagonal of the bounding box.
    constexpr double largest = sizeof(Scalarm) == sizeof(float) ? 1e18 : 1e37;
    for (const CVertexO& vertex : mesh.vert)
        for (int c = 0; c < 3 && !vertex.IsD(); ++c) {
            const double x = vertex.cP()[c];
            if (std::isfinite(x) && std::abs(x) > largest)
                throw MLException(QString("vertex %1 has a coordinate of %2, and the largest that "
                                          "can be filtered is %3: apply 'Transform: Scale, "
                                          "Normalize' first")
                                      .arg(vcg::tri::Index(mesh, vertex))
                                      .arg(x)
                                      .arg(largest));
        }
}

void reportWriting(const MeshMatrices& input, const CMeshO& mesh,
                   const spectral::Progress& progress) {
    progress.report(1.0, "writing the mesh");
    const MeshMatrices now = toMatrices(mesh);
    if (now.vertexIndex != input.vertexIndex || now.F.rows() != input.F.rows() ||
        now.F != input.F || now.V != input.V)
        throw MLException(
            "the mesh was edited while the filter was running, and has not been filtered: "
            "apply the filter again");
}

void setPositions(const std::vector<std::size_t>& vertexIndex, const spectral::Vertices& V,
                  MeshModel& mesh) {
    for (std::size_t i = 0; i < vertexIndex.size(); ++i)
        for (int c = 0; c < 3; ++c)
            mesh.cm.vert[vertexIndex[i]].P()[c] =
                static_cast<Scalarm>(V(static_cast<Eigen::Index>(i), c));
    mesh.updateBoxAndNormals();
}

void setQuality(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                MeshModel& mesh) {
    mesh.updateDataMask(MeshModel::MM_VERTQUALITY);
    for (std::size_t i = 0; i < vertexIndex.size(); ++i)
        mesh.cm.vert[vertexIndex[i]].Q() =
            static_cast<Scalarm>(values[static_cast<Eigen::Index>(i)]);
}

void setAttributes(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                   const Eigen::MatrixXd& values, MeshModel& mesh) {
    using Attributes = vcg::tri::Allocator<CMeshO>;
    const auto remove = [&](Eigen::Index j) {
        return Attributes::DeletePerVertexAttribute(mesh.cm, name + std::to_string(j));
    };
    Eigen::Index older = values.cols();
    while (remove(older)) ++older;  // the rest of a longer series
    for (Eigen::Index j = 0; j < values.cols(); ++j) {
        remove(j);  // names of VCG attributes must be unique, whatever their types
        auto attribute =
            Attributes::AddPerVertexAttribute<Scalarm>(mesh.cm, name + std::to_string(j));
        for (std::size_t i = 0; i < mesh.cm.vert.size(); ++i) attribute[i] = 0;
        for (std::size_t i = 0; i < vertexIndex.size(); ++i)
            attribute[vertexIndex[i]] =
                static_cast<Scalarm>(values(static_cast<Eigen::Index>(i), j));
    }
}
