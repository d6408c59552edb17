#include "core/analysis/noise_floor.h"

#include <cmath>

namespace spectral {

namespace {

/// Where relief is as high as the noise, a band needs 2^(1/2) times the height. Relief alone, also
/// that of creases and rims, falls by 2^1.5 per octave or more, that is by 2^(5/6) in height of
/// noise from one band to the next. This lies between the two, 2^(2/3).
constexpr double kRise = 1.587;

/// Part of the noise that is taken as it is: less is in a few slivers.
constexpr double kLeastPart = 0.05;

}  // namespace

NoiseFloor noiseFloor(const Eigen::VectorXd& featureSize, const Eigen::VectorXd& amplitude,
                      const Eigen::VectorXd& noise) {
    double energy = 0.0, part = 0.0, riseBefore = 1.0;
    NoiseFloor floor;
    for (Eigen::Index b = featureSize.size() - 1; b >= 0; --b) {
        if (part >= kLeastPart) {
            const double height = std::sqrt(energy / part);
            const double rise = amplitude[b] / noise[b] / height;
            if (!(rise <= kRise)) {
                // Between the middles of this band and the one before, along straight lines.
                const double t = std::log(kRise / riseBefore) / std::log(rise / riseBefore);
                floor.featureSize *= std::pow(featureSize[b] / floor.featureSize, t);
                break;
            }
            riseBefore = rise;
            floor.height = height;
        }
        energy += amplitude[b] * amplitude[b];
        part += noise[b] * noise[b];
        floor.featureSize = featureSize[b];
    }
    return floor.height > 0.0 ? floor : NoiseFloor{};
}

}  // namespace spectral
