#pragma once

#include <Eigen/Core>

#include "core/graph/face_graph.h"

namespace spectral {

/// Two copies of a noisy shape whose errors are independent, so that the result of any filter on
/// the one can be judged by the other, without the truth (Oliveira, Lei, Tibshirani 2021).
///
/// They are X + a b and X - b / a, with b drawn like the noise along the normals. It is drawn by
/// position, so that it does not depend on the numbering of the vertices.
class SplitNoise {
  public:
    /// Deviation of the noise of training(), over that of X: sqrt(1 + a^2) for a = 0.7.
    static constexpr double kGrowth = 1.2206555615733703;

    /// @param X       n x 3 positions.
    /// @param N       n x 3 unit normals of a denoised shape.
    /// @param height  n: standard deviation of the noise, length units.
    SplitNoise(const Points& X, Points N, Eigen::VectorXd height);

    /// n x 3 positions for filters to work on.
    const Points& training() const { return training_; }

    /// By how much the squared distances to the truth of the positions `other` (n x 3) exceed those
    /// of `result`, in standard deviations of this estimate; both are results of filters on
    /// training(). Distances are taken along the normals, as noise within the surface is not drawn.
    double gain(const Points& other, const Points& result) const;

  private:
    Points training_, judging_, N_;
    Eigen::VectorXd height_;
};

}  // namespace spectral
