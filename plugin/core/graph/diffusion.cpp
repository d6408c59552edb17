#include "core/graph/diffusion.h"

#include <cmath>
#include <random>

namespace spectral {

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
