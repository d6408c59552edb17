#pragma once

#include <functional>
#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// Estimate of the noise on the vertices of a mesh.
struct NoiseEstimate {
    double height = 0.0;  ///< Standard deviation along the normals, length units; 0 if none found.
    double size = 1.0;    ///< Correlation length, mean edges; 1: independent at every vertex.
    double correlation = 1.0;   ///< Correlation of neighbouring residuals: residualCorrelation.
    double meanEdge = 0.0;      ///< Mean edge length, length units.
    bool isUnderShape = false;  ///< White noise under a shape that is as high, such as ribs.
    bool isEven = false;        ///< Nearly white: isOtherNoise.
    bool isShape = false;       ///< Its octaves are those of natural ground or fine relief.
};

// What the estimates of a mesh and of its places have in common.
constexpr double kMinHeight = 0.02;    ///< Least height of white noise, mean edges.
constexpr double kRiseOfShape = 2.3;   ///< Least factor from an octave of a shape to the next.
constexpr double kResidualClip = 2.0;  ///< Deviations at which residuals are clipped.
constexpr double kMaxPureNoise = 0.1;  ///< Largest correlation of residuals without a shape.

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
/// @param N           n x 3 smoothVertexNormals, here and below.
/// @param isMeasured  n: whether a vertex counts.
/// @return  1 if all residuals vanish.
double residualCorrelation(const FaceGraph& graph, const Points& X, const Points& N,
                           const std::vector<bool>& isMeasured);

/// The residuals of the residuals, L L X along the normals, scaled so that those of white noise
/// have its deviation.
/// @param isMeasured  n: whether a vertex counts; those with a neighbour that does not are taken
/// out.
Eigen::VectorXd scaledSecondResiduals(const FaceGraph& graph, const Points& X, const Points& N,
                                      std::vector<bool>& isMeasured);

/// Second residuals as a whole: what alternates from vertex to vertex.
struct SecondResiduals {
    double height = 0.0;       ///< Standard deviation of the white noise that has these.
    double correlation = 1.0;  ///< Of neighbours; 1 if all vanish.

    /// Whether they are those of white noise.
    /// @param firstCorrelation  result of residualCorrelation: weak noise must alternate there,
    /// too.
    bool isNoise(double firstCorrelation, double meanEdge) const;
};

/// Tells white noise from the shape under it where that is as high, such as steep ground, cells of
/// few vertices, ribs and knurls: L L suppresses a wave of six edges 20 times as strongly as noise.
SecondResiduals secondResiduals(const FaceGraph& graph, const Points& X, const Points& N,
                                std::vector<bool> isMeasured);

/// Whether residuals that are not those of white noise are noise all the same, such as that of data
/// coarser than the mesh, or of a volume of distances, whose vertices slide on the edges of its
/// grid: an octave of them is alike everywhere, has the distribution of noise, and the next one
/// rises by less than that of a shape.
/// @param first   result of residualCorrelation.
/// @param second  correlation of secondResiduals.
bool isOtherNoise(const FaceGraph& graph, const Points& X, const Points& N,
                  const std::vector<bool>& isMeasured, double first, double second);

/// Height and correlation length of the noise, from the energies along the normals in seven octaves
/// of lazy diffusion, (I + P) / 2 to the powers 0, 1, 2, 4, ... 64.
///
/// Each deviation is divided by that of white noise of height 1 in the same octave. White noise is
/// then the same in all octaves; from each octave to the next coarser one, scanner noise rises by a
/// factor of 1.3 to 2, and a shape by 2.3 to 3. From the finest octave on, whatever a shape cannot
/// explain is noise. Medians exclude creases and single outliers.
/// @param correlation  result of residualCorrelation; if it is that of white noise, the size is 1.
/// @param second       result of secondResiduals, likewise.
/// @param isOther      result of isOtherNoise.
NoiseEstimate estimateNoise(const FaceGraph& graph, const Points& X, const Points& N,
                            const std::vector<bool>& isMeasured, double correlation,
                            const SecondResiduals& second, bool isOther, double meanEdge);

}  // namespace spectral
