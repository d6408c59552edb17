#pragma once

#include <common/ml_document/mesh_model.h>

#include <Eigen/Core>
#include <vector>

// Colours of numbers at the vertices: one map for numbers with a sign, one for sizes.

/// Blue below 0, white at 0, red above; full colour from `extent` on, which is > 0.
void setSignedColors(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                     double extent, MeshModel& mesh);

/// White at 0, over orange to dark red from `extent` on, which is > 0.
void setSizeColors(const std::vector<std::size_t>& vertexIndex, const Eigen::VectorXd& values,
                   double extent, MeshModel& mesh);
