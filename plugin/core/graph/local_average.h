#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/graph/diffusion.h"

namespace spectral {

/// The coefficients of lazy diffusion, ((1 + P) / 2)^steps, in Chebyshev polynomials T_j(P):
/// binomials over 4^steps, which vanish beyond some 3 sqrt(steps).
std::vector<double> diffusionCoefficients(int steps);

/// X <- ((1 + P) / 2)^steps X by the Chebyshev recurrence, to 1e-4 of the largest value.
template <class Rows>
void diffuseFast(const VertexGraph& graph, int steps, Rows& X) {
    const std::vector<double> coefficients = diffusionCoefficients(steps);
    Rows before = X, here = X, next = X;
    forEachMean(graph, X, [&](Index i, const auto& mean) { here.row(i) = mean; });
    X = coefficients[0] * before + coefficients[1] * here;
    for (std::size_t j = 2; j < coefficients.size(); ++j) {
        forEachMean(graph, here, [&](Index i, const auto& mean) {
            next.row(i) = 2.0 * mean - before.row(i);
            X.row(i) += coefficients[j] * next.row(i);
        });
        before.swap(here);
        here.swap(next);
    }
}

/// Averages over the place of each vertex: by lazy diffusion, without patches or seeds, so that
/// they do not depend on the numbering of the vertices. k steps average about 3.6 k vertices.
class LocalAverage {
  public:
    /// @param counts  n: whether a vertex counts; kept by reference.
    LocalAverage(const VertexGraph& graph, const std::vector<bool>& counts, int steps);

    /// Average of each column of X, n x C; modifies X.
    template <class Rows>
    Rows of(Rows X) const {
        for (Index i = 0; i < X.rows(); ++i)
            if (!counts_[i]) X.row(i).setZero();
        diffuseFast(graph_, steps_, X);
        parallelRows(X.rows(), [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i) X.row(i) /= weight_[i];
        });
        return X;
    }

    /// Standard deviation of values of mean 0: squares are clipped at 1.5 deviations (Huber's
    /// proposal 2, 1964), robust against creases and single outliers.
    template <class Rows>
    Rows deviation(const Rows& values) const {
        constexpr int kClippings = 4;
        constexpr double kClip = 1.5, kClippedVariance = 0.7785;  // of a normal distribution
        constexpr double kRoot = 1.48;  // over the squared mean of its square roots
        Rows s = of(Rows(values.array().abs().sqrt())).array().square() * kRoot;
        for (int k = 0; k < kClippings; ++k)
            s = (of(Rows(values.array().square().min((kClip * s.array()).square())))
                     .array()
                     .max(0.0) /
                 kClippedVariance)
                    .sqrt();
        return s;
    }

  private:
    const VertexGraph& graph_;
    const std::vector<bool>& counts_;
    int steps_;
    Eigen::VectorXd weight_;
};

}  // namespace spectral
