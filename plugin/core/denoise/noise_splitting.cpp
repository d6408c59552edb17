#include "core/denoise/noise_splitting.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/graph/diffusion.h"

namespace spectral {

namespace {

constexpr double kShare = 0.7;

/// Independent samples of the standard normal distribution (Box and Muller 1958), by position.
Eigen::VectorXd whiteNoiseAt(const Points& X) {
    constexpr double kRange = 4294967296.0;
    const std::vector<std::uint64_t> bits = randomBits(X);
    Eigen::VectorXd values(X.rows());
    for (Index i = 0; i < X.rows(); ++i) {
        const double one = (static_cast<double>(bits[i] >> 32) + 0.5) / kRange,
                     other = (static_cast<double>(bits[i] & 0xffffffff) + 0.5) / kRange;
        values[i] = std::sqrt(-2.0 * std::log(one)) * std::cos(2.0 * kPi * other);
    }
    return values;
}

}  // namespace

SplitNoise::SplitNoise(const Points& X, Points N, Eigen::VectorXd height)
    : N_(std::move(N)), height_(std::move(height)) {
    const Points noise = whiteNoiseAt(X).cwiseProduct(height_).asDiagonal() * N_;
    training_ = X + kShare * noise;
    judging_ = X - noise / kShare;
}

double SplitNoise::gain(const Points& other, const Points& result) const {
    const auto along = [&](const Points& Y) -> Eigen::VectorXd {
        return (Y - judging_).cwiseProduct(N_).rowwise().sum();
    };
    const Eigen::VectorXd before = along(other), after = along(result);
    // Given the results, only the noise of `judging` is random: sqrt(1 + 1 / a^2) of that of X.
    const double deviation = 2.0 * kGrowth / kShare * (before - after).cwiseProduct(height_).norm();
    return deviation > 0.0 ? (before.squaredNorm() - after.squaredNorm()) / deviation : 0.0;
}

}  // namespace spectral
