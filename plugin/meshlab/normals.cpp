#include "meshlab/normals.h"

#include <array>
#include <vector>

#include "core/support/threads.h"

// MeshModel::updateBoxAndNormals takes a thirteenth of the default filter's time on two threads.
void updateNormals(CMeshO& mesh) {
    std::vector<std::array<Scalarm, 3>> angles(mesh.face.size());
    const spectral::ThreadTeam team;
    spectral::parallelRows(static_cast<spectral::Index>(angles.size()), [&](auto begin, auto end) {
        for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
            CFaceO& face = mesh.face[t];
            if (face.IsD()) continue;
            face.N() = vcg::TriangleNormal(face).Normalize();
            std::array<Point3m, 3> edge;  // from each corner to the next
            for (int c = 0; c < 3; ++c) edge[c] = (face.cP1(c) - face.cP(c)).Normalize();
            for (int c = 0; c < 3; ++c) angles[t][c] = vcg::AngleN(edge[c], -edge[(c + 2) % 3]);
        }
    });

    for (CFaceO& face : mesh.face)
        if (!face.IsD())
            for (int c = 0; c < 3; ++c) face.V(c)->N().SetZero();
    for (std::size_t t = 0; t < angles.size(); ++t) {
        CFaceO& face = mesh.face[t];
        if (!face.IsD())
            for (int c = 0; c < 3; ++c) face.V(c)->N() += face.cN() * angles[t][c];
    }
}
