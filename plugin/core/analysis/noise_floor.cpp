#include "core/analysis/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spectral {

NoiseFloor noiseFloor(const Eigen::VectorXd& featureSize, const Eigen::VectorXd& amplitude,
                      const Eigen::VectorXd& noise) {
    // Largest rise of the noise height from band to band within the floor, 2^(2/3). It is 2^(1/2)
    // where relief is as high as the noise, and 2^(5/6) for relief alone, which falls by 2^1.5 per
    // octave or more, even at creases and boundaries.
    constexpr double kMaxRise = 1.587;
    // Share of the noise that is always accepted: less may come from a few slivers.
    constexpr double kMinPart = 0.05;
    double energy = 0.0, part = 0.0, riseBefore = 1.0;
    NoiseFloor floor;
    for (Eigen::Index b = featureSize.size() - 1; b >= 0; --b) {
        if (part >= kMinPart) {
            const double height = std::sqrt(energy / part);
            const double rise = amplitude[b] / noise[b] / height;
            if (!(rise <= kMaxRise)) {
                // Interpolate between the centres of this band and the previous one.
                const double before = std::log(riseBefore);
                const double t = (std::log(kMaxRise) - before) / (std::log(rise) - before);
                floor.featureSize *= std::pow(featureSize[b] / floor.featureSize, t);
                break;
            }
            riseBefore = std::max(rise, std::numeric_limits<double>::min());  // 0: no energy
            floor.height = height;
        }
        energy += amplitude[b] * amplitude[b];
        part += noise[b] * noise[b];
        floor.featureSize = featureSize[b];
    }
    return floor.height > 0.0 ? floor : NoiseFloor{};
}

}  // namespace spectral
