#include "core/graph/diffusion.h"

#include <cmath>

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
    // As fine as single precision tells positions apart, and coarser than the rounding of a mesh
    // that is scaled or moved.
    constexpr double kPlaces = 67108864.0;
    std::vector<std::uint64_t> bits(static_cast<std::size_t>(X.rows()), 0);
    if (X.rows() == 0) return bits;
    // Largest and smallest values do not depend on the order of the vertices, as a mean does.
    const Eigen::RowVector3d most = X.colwise().maxCoeff(), least = X.colwise().minCoeff();
    const Eigen::RowVector3d centre = 0.5 * (most + least);
    const double extent = (most - least).maxCoeff(), scale = extent > 0.0 ? kPlaces / extent : 0.0;
    parallelRows(X.rows(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i)
            for (int c = 0; c < 3; ++c)
                bits[i] = mixed(bits[i] ^ static_cast<std::uint64_t>(
                                              std::llround((X(i, c) - centre[c]) * scale)));
    });
    return bits;
}

}  // namespace spectral
