#include "core/laplacian/frequency.h"

#include <cmath>
#include <string>

#include "core/support/errors.h"
#include "core/support/types.h"

namespace spectral {

double cutoffFrequency(double featureSize) {
    if (!std::isfinite(featureSize) || featureSize <= 0.0)
        throw InvalidOption("feature_size = " + textOf(featureSize) +
                            ": must be a length above zero, e.g. 5 % of the bounding box diagonal");
    return 2.0 * kPi / featureSize;
}

double defaultFeatureSize(double meanEdge, double diagonal) {
    const double size = 6.0 * meanEdge, most = 0.05 * diagonal;
    return size > 0.0 && size < most ? size : most;
}

double defaultSmallestSize(double meanEdge, double diagonal) {
    return 0.5 * defaultFeatureSize(meanEdge, diagonal);
}

}  // namespace spectral
