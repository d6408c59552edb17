#pragma once

#include <common/ml_document/mesh_model.h>
#include <common/parameters/rich_parameter_list.h>

#include <QStringList>
#include <string>
#include <vector>

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"
#include "meshlab/mesh_conversion.h"

/// The value of an enumeration parameter, which a script can set to any number.
/// @param choices  in the order of the core's enumeration.
/// @throws spectral::InvalidOption  when it is not one of the choices.
int choice(const RichParameterList& parameters, const char* name, const QStringList& choices);

// Parameters that several filters share, with the same names and defaults.

/// Mean edge length, in the mesh's units; 0 without faces.
double meanEdge(const MeshModel& mesh);

/// Diagonal of the bounding box of the vertices that faces use, in the mesh's units; without faces,
/// of all. Defaults refer to it; percentages refer to the bounding box of all vertices, as in
/// MeshLab's own filters.
double surfaceDiagonal(const MeshModel& mesh);

/// Warns of vertices without faces that enlarge the diagonal by more than 1 %: percentages then do
/// not mean what they seem to.
std::vector<std::string> percentageWarnings(const MeshMatrices& input);

/// A sentence with the mean edge length, for the help of size parameters; empty for 0.
QString meanEdgeText(double meanEdge);

/// `feature_size`, a percentage of the bounding box diagonal; default:
/// spectral::defaultFeatureSize.
RichPercentage featureSizeParameter(const MeshModel& mesh, const QString& help);

/// The feature size as a length.
double featureSize(const RichParameterList& parameters);

/// Whether `feature_size` is the default of this mesh: a size that nobody chose.
bool isDefaultFeatureSize(const RichParameterList& parameters, const MeshModel& mesh,
                          const MeshMatrices& matrices);

/// `selected`; default: whether any face is selected, as in MeshLab's own filters.
/// @param width  distance within which the filter fades out around the selection, in words.
RichBool selectedParameter(const MeshModel& mesh, const QString& width = "about a feature size");

/// Whether each vertex is to be filtered, according to `selected`; empty: all.
std::vector<bool> chosenVertices(const RichParameterList& parameters, const MeshModel& mesh,
                                 const MeshMatrices& matrices);

/// "only the selection: 44 of 642 vertices": other filters leave selections behind unnoticed. Empty
/// if everything is filtered.
/// @param selected  one value per vertex, or empty.
std::string selectionText(const std::vector<bool>& selected);

/// Default tolerance of automatic steps: 0.05 % of the diagonal.
double defaultTolerance(const MeshModel& mesh);

/// `laplacian`; default: intrinsic Delaunay.
RichEnum laplacianParameter();

spectral::LaplacianKind laplacianKind(const RichParameterList& parameters);

/// The choices of `boundary`, in the order of the core's enumeration.
QStringList boundaries();

/// `boundary`; default: free.
/// @param help  describes the effect of each choice.
RichEnum boundaryParameter(const QString& help);

spectral::Boundary boundaryCondition(const RichParameterList& parameters);
