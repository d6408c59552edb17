#include "core/graph/diffusion.h"

#include <cmath>
#include <random>

namespace spectral {

namespace {

/// A bijection whose bits depend on all those of its argument (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t bits) {
    bits += 0x9e3779b97f4a7c15;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
    return bits ^ (bits >> 31);
}

}  // namespace

std::vector<std::uint64_t> randomBits(const Points& X) {
    // Finer than single precision tells positions apart, and coarser than the rounding of a mesh
    // that is scaled or moved.
    constexpr double kPlaces = 1073741824.0;
    const Eigen::RowVector3d centre = X.colwise().mean();
    const double radius =
        std::sqrt((X.rowwise() - centre).rowwise().stableNorm().cwiseAbs2().mean());
    std::vector<std::uint64_t> bits(static_cast<std::size_t>(X.rows()), 0);
    for (Index i = 0; i < X.rows(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double place = radius > 0.0 ? (X(i, c) - centre[c]) / radius * kPlaces : 0.0;
            bits[i] = mixed(bits[i] ^ static_cast<std::uint64_t>(std::llround(place)));
        }
    return bits;
}

Eigen::VectorXd whiteNoise(Index count) {
    // Box and Muller 1958; std::normal_distribution differs between standard libraries.
    constexpr double kRange = 4294967296.0;
    std::mt19937 random(1);
    const auto uniform = [&] { return (static_cast<double>(random()) + 0.5) / kRange; };
    Eigen::VectorXd values(count);
    for (Index i = 0; i < count; i += 2) {
        const double radius = std::sqrt(-2.0 * std::log(uniform())), angle = 2.0 * kPi * uniform();
        values[i] = radius * std::cos(angle);
        if (i + 1 < count) values[i + 1] = radius * std::sin(angle);
    }
    return values;
}

}  // namespace spectral
