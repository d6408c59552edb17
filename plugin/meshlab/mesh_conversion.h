#pragma once

#include <common/ml_document/mesh_model.h>

#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/support/progress.h"
#include "core/support/types.h"

/// A mesh of MeshLab's as matrices, without the deleted elements that stay in its containers.
struct MeshMatrices {
    spectral::Vertices V;
    spectral::Faces F;
    std::vector<std::size_t> vertexIndex;  ///< Index in the container of every row of V.
};

MeshMatrices toMatrices(const CMeshO& mesh);

/// Reports that the mesh is to be written next, the last moment to stop.
/// @throws InvalidMesh  when it is not `input` any more: MeshLab lets its user edit it meanwhile.
void reportWriting(const MeshMatrices& input, const CMeshO& mesh,
                   const spectral::Progress& progress);

/// Moves the vertices to the rows of V and updates bounding box and normals; all else is kept.
void setPositions(const std::vector<std::size_t>& vertexIndex, const spectral::Vertices& V,
                  MeshModel& mesh);

/// Sets the vertex quality to the entries of `values`.
void setQuality(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                MeshModel& mesh);

/// Stores the columns of `values` as scalar vertex attributes `name`0, `name`1, ..., in place of
/// all that had such a name. Other vertices, those deleted, have 0.
void setAttributes(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                   const Eigen::MatrixXd& values, MeshModel& mesh);
