#pragma once

#include <common/ml_document/mesh_model.h>
#include <common/parameters/rich_parameter_list.h>

#include "core/laplacian/frequency.h"
#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"

/// The parameters that several filters have, under one name, with one default.

/// `feature_size`, a percentage of the diagonal of the bounding box, by default what suits the mesh
/// (spectral::defaultFeatureSize).
RichPercentage featureSizeParameter(const MeshModel& mesh, const QString& help);

/// The feature size as a length.
double featureSize(const RichParameterList& parameters);

/// `laplacian`, by default the intrinsic Delaunay one.
RichEnum laplacianParameter(const QString& help);

spectral::LaplacianKind laplacianKind(const RichParameterList& parameters);

/// `boundary`, by default free.
RichEnum boundaryParameter(const QString& help);

spectral::Boundary boundaryCondition(const RichParameterList& parameters);
