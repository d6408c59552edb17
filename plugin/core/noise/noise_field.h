#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// The residuals along the normals, and their deviation in the place of each vertex.
struct LocalResiduals {
    Points N;                   ///< n x 3 smooth unit normals.
    Eigen::VectorXd residual;   ///< n: scaledResiduals, 0 where not measured.
    Eigen::VectorXd deviation;  ///< n: over some 30 vertices, length units.
};

LocalResiduals localResiduals(const FaceGraph& graph, const Points& X,
                              const std::vector<bool>& isMeasured);

/// Whether the residuals are of like height everywhere, in length units or in edges of the place.
bool areAlike(const FaceGraph& graph, const Points& X, const LocalResiduals& residuals,
              const std::vector<bool>& isMeasured);

/// 99 % quantile of the residuals of some vertices, in deviations of their places, where those on
/// creases count as 0: at most 2.5 for noise, whatever its distribution over the surface, more for
/// spikes; 0 if there are none.
double localTail(const VertexGraph& graph, const LocalResiduals& residuals,
                 const std::vector<bool>& isIncluded);

/// The height of white noise at every vertex of a surface that is noisy in places.
struct NoiseField {
    Eigen::VectorXd height;  ///< n: standard deviation along the normals, length units; 0: none.
                             ///< Empty if there is no noise anywhere.
    Eigen::VectorXd edge;    ///< n: mean edge length of the place, length units.
    double share = 0.0;      ///< Share of the measured vertices with noise.
    double lowest = 0.0, median = 0.0, highest = 0.0;  ///< 10, 50 and 98 % quantiles of height
                                                       ///< over edge, where there is noise.

    /// The same height at all n vertices, length units.
    static NoiseField ofHeight(double height, double edge, Index n);

    /// The given heights at all n vertices, length units, at least 0.
    static NoiseField ofHeights(const FaceGraph& graph, const Points& X,
                                const Eigen::VectorXd& heights);

    bool isAny() const { return height.size() > 0; }
    bool isEverywhere() const { return share > 0.97; }

    /// Whether it is the same at all vertices, as that of ofHeight.
    bool isAlike() const {
        return isAny() && height.minCoeff() == height.maxCoeff() &&
               edge.minCoeff() == edge.maxCoeff();
    }
};

/// Measures noise where it is, by the correlation of neighbouring residuals (residualCorrelation)
/// and the octaves of estimateNoise, averaged over the place of each vertex instead of the mesh.
///
/// Noise is certain where the residuals are anticorrelated on average over the 460 nearest vertices
/// and it has some height. From there it extends over all connected vertices where both hold more
/// weakly. At its edge the louder side would decide such an average; so each residual is then
/// divided by the deviation of its own place, and their correlation over the 90 nearest vertices
/// must be that of noise, too. The height is that of the finest octave, over 30 vertices, less what
/// a shape explains.
///
/// @param X           n x 3 positions.
/// @param isMeasured  n: whether a vertex counts; not those on rims.
NoiseField measureNoiseField(const FaceGraph& graph, const Points& X,
                             const std::vector<bool>& isMeasured, const LocalResiduals& residuals);

}  // namespace spectral
