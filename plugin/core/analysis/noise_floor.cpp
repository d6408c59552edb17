#include "core/analysis/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spectral {

double noiseFeatureSize(double height, const Eigen::VectorXd& featureSize,
                        const Eigen::VectorXd& amplitude, const Eigen::VectorXd& noise) {
    constexpr double kMaxRise = 1.6;
    if (!(height > 0.0)) return 0.0;
    double size = 0.0, riseBefore = 1.0;
    for (Eigen::Index b = featureSize.size() - 1; b >= 0; --b) {
        const double rise = amplitude[b] / noise[b] / height;
        if (!(rise <= kMaxRise)) {
            if (size == 0.0) break;
            // Interpolate between the centres of this band and the previous one.
            const double before = std::log(riseBefore);
            const double t = (std::log(kMaxRise) - before) / (std::log(rise) - before);
            return size * std::pow(featureSize[b] / size, t);
        }
        riseBefore = std::max(rise, std::numeric_limits<double>::min());  // 0: no energy
        size = featureSize[b];
    }
    return size;
}

}  // namespace spectral
