#pragma once

#include <common/ml_document/mesh_model.h>

#include <Eigen/Core>
#include <vector>

/// Colours a signed function: blue below 0, white at 0, red above; the largest modulus has the full
/// colour.
///
/// @param vertexIndex  container index of every entry of `values`.
/// @param values       finite.
void setDivergingColors(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                        MeshModel& mesh);
