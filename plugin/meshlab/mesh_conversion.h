#pragma once

#include <common/ml_document/mesh_model.h>

#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/support/progress.h"

/// A mesh of MeshLab as matrices, without the deleted elements in its containers.
struct MeshMatrices {
    spectral::Vertices V;
    spectral::Faces F;
    std::vector<std::size_t> vertexIndex;  ///< Container index of every row of V.
};

MeshMatrices toMatrices(const CMeshO& mesh);

/// @throws MLException  when coordinates are so large, or the mesh so small, that the lengths among
/// the parameters, which MeshLab keeps in single precision, would be infinite or zero.
void checkExtent(const CMeshO& mesh);

/// Whether each row of `matrices` is selected: a vertex itself, or a face that it is a corner of.
std::vector<bool> selectedVertices(const CMeshO& mesh, const MeshMatrices& matrices);

/// Whether any face is selected.
bool hasSelectedFaces(const CMeshO& mesh);

/// The vertex quality of each row.
Eigen::VectorXd vertexQuality(const CMeshO& mesh, const MeshMatrices& matrices);

/// Reports progress before the mesh is written, the last opportunity to cancel.
/// @throws MLException  when the mesh is no longer `input`: MeshLab lets the user edit it
/// meanwhile.
void reportWriting(const MeshMatrices& input, const CMeshO& mesh,
                   const spectral::Progress& progress);

/// Moves the vertices to the rows of V, and updates bounding box and normals, to MeshLab's bits;
/// vertices without faces keep their normals.
void setPositions(const MeshMatrices& input, const spectral::Vertices& V, MeshModel& mesh);

/// Sets the vertex quality to the entries of `values`.
void setQuality(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                MeshModel& mesh);

/// Stores the rows of `details` as the vector vertex attribute `name`, zero at deleted vertices,
/// and their components along the vertex normals as the vertex quality.
void setDetails(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                const spectral::Vertices& details, MeshModel& mesh);

/// Stores the columns of `values` as scalar vertex attributes `name`0, `name`1, ..., replacing all
/// of such names; 0 at deleted vertices.
void setAttributes(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                   const Eigen::MatrixXd& values, MeshModel& mesh);
