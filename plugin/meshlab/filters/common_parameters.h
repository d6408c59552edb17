#pragma once

#include <common/ml_document/mesh_model.h>
#include <common/parameters/rich_parameter_list.h>

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"

// Parameters that several filters share, with the same names and defaults.

/// `feature_size`, a percentage of the bounding box diagonal; default:
/// spectral::defaultFeatureSize.
RichPercentage featureSizeParameter(const MeshModel& mesh, const QString& help);

/// The feature size as a length.
double featureSize(const RichParameterList& parameters);

/// `laplacian`; default: intrinsic Delaunay.
RichEnum laplacianParameter(const QString& help);

spectral::LaplacianKind laplacianKind(const RichParameterList& parameters);

/// `boundary`; default: free.
RichEnum boundaryParameter(const QString& help);

spectral::Boundary boundaryCondition(const RichParameterList& parameters);
