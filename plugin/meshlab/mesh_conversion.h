#pragma once

#include <common/ml_document/mesh_model.h>

#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/support/progress.h"

/// A MeshLab mesh as matrices, without the deleted elements of its containers.
struct MeshMatrices {
    spectral::Vertices V;
    spectral::Faces F;
    std::vector<std::size_t> vertexIndex;  ///< Container index of each row of V.
};

MeshMatrices toMatrices(const CMeshO& mesh);

/// @throws MLException  when the coordinates are so large, or the mesh so small, that length
/// parameters, which MeshLab stores in single precision, would be infinite or zero.
void checkExtent(const CMeshO& mesh);

/// Whether each vertex is selected, itself or as a corner of a selected face.
std::vector<bool> selectedVertices(const CMeshO& mesh, const MeshMatrices& matrices);

/// Whether any face is selected.
bool hasSelectedFaces(const CMeshO& mesh);

/// The vertex quality of each row.
Eigen::VectorXd vertexQuality(const CMeshO& mesh, const MeshMatrices& matrices);

/// Red, green and blue of each row, 0 to 255.
Eigen::MatrixXd vertexColors(const CMeshO& mesh, const MeshMatrices& matrices);

/// Reports that the mesh is about to be written, the last opportunity to cancel.
/// @throws MLException  when the mesh differs from `input`: users can edit it during a run.
void reportWriting(const MeshMatrices& input, const CMeshO& mesh,
                   const spectral::Progress& progress);

/// Moves the vertices to the rows of V and updates the bounding box and the normals, bit for bit as
/// MeshLab does; vertices without faces keep their normals.
void setPositions(const MeshMatrices& input, const spectral::Vertices& V, MeshModel& mesh);

/// Sets the vertex quality to the entries of `values`.
void setQuality(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                MeshModel& mesh);

/// The components of vectors along the vertex normals.
Eigen::VectorXd alongNormals(const MeshMatrices& matrices, const spectral::Vertices& vectors,
                             const CMeshO& mesh);

/// Stores the rows of `vectors` as the vector vertex attribute `name`, zero at deleted vertices.
void setVectors(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                const spectral::Vertices& vectors, MeshModel& mesh);

/// Stores `values` as the scalar vertex attribute `name`, 0 at deleted vertices.
void setAttribute(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                  const Eigen::VectorXd& values, MeshModel& mesh);

/// Stores the columns of `values` as scalar vertex attributes `name`0, `name`1, ..., replacing any
/// with such names; 0 at deleted vertices.
void setAttributes(const std::vector<std::size_t>& vertexIndex, const std::string& name,
                   const Eigen::MatrixXd& values, MeshModel& mesh);
