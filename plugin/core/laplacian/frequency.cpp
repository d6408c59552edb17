#include "core/laplacian/frequency.h"

#include <cmath>
#include <string>

#include "core/support/errors.h"
#include "core/support/types.h"

namespace spectral {

double cutoffFrequency(double featureSize) {
    if (!std::isfinite(featureSize) || featureSize <= 0.0)
        throw InvalidOption("feature_size = " + std::to_string(featureSize) +
                            ": a feature size is a length above zero, e.g. 5 % of the diagonal of "
                            "the bounding box");
    return 2.0 * kPi / featureSize;
}

double defaultFeatureSize(double meanEdge, double diagonal) {
    constexpr double kEdges = 6.0, kShare = 0.05;
    const double size = kEdges * meanEdge, most = kShare * diagonal;
    return size > 0.0 && size < most ? size : most;
}

}  // namespace spectral
