#pragma once

#include <functional>
#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// Estimate of the noise on the vertices of a mesh.
struct NoiseEstimate {
    double height = 0.0;  ///< Standard deviation along the normals, length units; 0 if none found.
    double size = 1.0;    ///< Correlation length, mean edges; 1: independent at every vertex.
    double correlation = 1.0;  ///< Correlation of neighbouring residuals: residualCorrelation.
    double meanEdge = 0.0;     ///< Mean edge length, length units.
};

// What the estimates of a mesh and of its places have in common.
constexpr double kMinHeight = 0.02;    ///< Least height of white noise, mean edges.
constexpr double kRiseOfShape = 2.3;   ///< Least factor from an octave of a shape to the next.
constexpr double kResidualClip = 2.0;  ///< Deviations at which residuals are clipped.

/// Unit vertex normals that vary less than the noise, n x 3.
/// @param blurs  of the normals of the faces.
Points smoothVertexNormals(const FaceGraph& graph, const Points& X, int blurs = 3);

/// Residuals L X along the normals N, scaled so that those of white noise have its deviation.
Eigen::VectorXd scaledResiduals(const VertexGraph& graph, const Points& X, const Points& N);

/// Called for octave k with the difference that lazy diffusion makes in it along the normals, n
/// values, and the standard deviation of the difference that it makes in white noise of height 1.
using OctaveVisitor = std::function<void(int k, Eigen::VectorXd along, double white)>;

/// Visits the first `count` octaves: differences between (I + P) / 2 to the powers 0, 1, 2, 4, ...
void forEachOctave(const VertexGraph& graph, const Points& X, const Points& N,
                   const std::vector<bool>& isMeasured, int count, const OctaveVisitor& visit);

/// Correlation between neighbours of the residuals L X along the normals, clipped at two
/// deviations.
///
/// It is -0.24 for independent noise and up to 0.16 for that of scanners; 0.23 and more for a shape
/// without noise, whose curvature varies slowly.
/// @param X           n x 3 positions.
/// @param isMeasured  n: whether a vertex counts.
/// @param shapeSteps  the average over so many steps of lazy diffusion is taken off first, as
///                    curvature; 0: nothing is.
/// @return  1 if all residuals vanish.
double residualCorrelation(const FaceGraph& graph, const Points& X,
                           const std::vector<bool>& isMeasured, int shapeSteps = 0);

/// Height and correlation length of the noise, from the energies along the normals in seven octaves
/// of lazy diffusion, (I + P) / 2 to the powers 0, 1, 2, 4, ... 64.
///
/// Each deviation is divided by that of white noise of height 1 in the same octave. White noise is
/// then the same in all octaves; from each octave to the next coarser one, scanner noise rises by a
/// factor of 1.3 to 2, and a shape by 2.3 to 3. From the finest octave on, whatever a shape cannot
/// explain is noise. Medians exclude creases and single outliers.
/// @param correlation  result of residualCorrelation; if it is that of white noise, the size is 1.
NoiseEstimate estimateNoise(const FaceGraph& graph, const Points& X,
                            const std::vector<bool>& isMeasured, double correlation,
                            double meanEdge);

}  // namespace spectral
