#pragma once

#include <common/ml_document/mesh_model.h>
#include <common/parameters/rich_parameter_list.h>

#include <QStringList>
#include <string>
#include <vector>

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "meshlab/mesh_conversion.h"

/// The value of an enumeration, in which a script can have any number.
/// @param choices  in the order of the core's enumeration.
/// @throws spectral::InvalidOption  when it is none of the choices.
int choice(const RichParameterList& parameters, const char* name, const QStringList& choices);

// Parameters that several filters share, with the same names and defaults.

/// Mean edge length, in the mesh's units; 0 without faces.
double meanEdge(const MeshModel& mesh);

/// A sentence for the help of sizes: how long a mean edge is; none for 0.
QString meanEdgeTold(double meanEdge);

/// `feature_size`, a percentage of the bounding box diagonal; default:
/// spectral::defaultFeatureSize.
RichPercentage featureSizeParameter(const MeshModel& mesh, const QString& help);

/// The feature size as a length.
double featureSize(const RichParameterList& parameters);

/// `selected`; default: whether a face is, as in MeshLab's own filters.
/// @param width  within which a filter fades out around the selection, in words.
RichBool selectedParameter(const MeshModel& mesh, const QString& width = "about a feature size");

/// Whether `selected` chooses each vertex; empty: all are.
std::vector<bool> chosenVertices(const RichParameterList& parameters, const MeshModel& mesh,
                                 const MeshMatrices& matrices);

/// "only the selection: 44 of 642 vertices", since other filters leave selections behind unasked;
/// empty if everything is filtered.
/// @param selected  one value for each vertex, or none.
std::string selectionTold(const std::vector<bool>& selected);

/// Default tolerance of automatic steps, relative to the bounding box diagonal: half a pixel of a
/// mesh shown 1,000 pixels wide.
constexpr double kDefaultTolerance = 0.0005;

/// `laplacian`; default: intrinsic Delaunay.
RichEnum laplacianParameter();

spectral::LaplacianKind laplacianKind(const RichParameterList& parameters);

/// The choices of `boundary`, in the order of the core's enumeration.
QStringList boundaries();

/// `boundary`; default: free.
/// @param help  what its choices do.
RichEnum boundaryParameter(const QString& help);

spectral::Boundary boundaryCondition(const RichParameterList& parameters);
