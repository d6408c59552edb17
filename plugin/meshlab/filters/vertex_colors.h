#pragma once

#include <common/ml_document/mesh_model.h>

#include <Eigen/Core>
#include <vector>

/// Colours a function of two signs: blue where it is lowest, white at 0, red where it is highest.
/// Symmetric about 0: the largest absolute value has the full colour.
///
/// @param vertexIndex  index in the container of every entry of `values`.
/// @param values       finite.
void setDivergingColors(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                        MeshModel& mesh);
