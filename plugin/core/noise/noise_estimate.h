#pragma once

#include <vector>

#include "core/noise/face_graph.h"

namespace spectral {

/// What a mesh tells about noise that all its vertices have.
struct NoiseEstimate {
    double height = 0.0;  ///< Standard deviation along the normals, length units; 0: none seen.
    double size = 1.0;    ///< Correlation length, mean edges; 1: independent at every vertex.
    double correlation = 1.0;  ///< Of neighbouring vertices, see residualCorrelation.
    double meanEdge = 0.0;     ///< Mean edge length, length units.
};

/// Correlation of the residuals L X along the normals between neighbours, with residuals clipped at
/// two deviations.
///
/// Independent noise has -0.24, that of scanners up to 0.16; a shape without noise 0.23 and more,
/// since its curvature varies slowly.
/// @param X           n x 3 positions.
/// @param isMeasured  n: vertices that count.
/// @return  1 where there is no residual.
double residualCorrelation(const FaceGraph& graph, const Points& X,
                           const std::vector<bool>& isMeasured);

/// Height and correlation length of the noise, from the energies along the normals of seven octaves
/// of lazy diffusion, (I + P) / 2 to the powers 0, 1, 2, 4, ... 64.
///
/// Each deviation is divided by that of white noise of height 1 in the same octave. White noise
/// then has the same in all, a scanner's rises by 1.3 to 2 from one to the next coarser one, and a
/// shape by 2.3 to 3. What a shape alone cannot explain, in octaves from the finest on, is noise.
/// Medians leave creases and single outliers out.
/// @param correlation  see residualCorrelation: where it is that of white noise, so is the size.
NoiseEstimate estimateNoise(const FaceGraph& graph, const Points& X,
                            const std::vector<bool>& isMeasured, double correlation,
                            double meanEdge);

}  // namespace spectral
