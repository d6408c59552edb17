#include "core/contract/transfer_fields.h"

#include <algorithm>
#include <vector>

#include "core/support/frequency.h"
#include "core/support/types.h"
#include "core/transfer/custom_gain.h"
#include "core/transfer/equalizer.h"

namespace spectral {

namespace {

/// Finer than the least gain of an equalizer, 0.001, for which it would take a 0.
constexpr double kNoGain = 1e-12;

Equalizer equalizerOf(const Eigen::MatrixXd& samples, double featureSize) {
    std::vector<SizedGain> points;
    for (Index i = 0; i < samples.rows(); ++i)
        points.push_back({featureSize / samples(i, 0), std::max(samples(i, 1), kNoGain)});
    return Equalizer(points);
}

}  // namespace

void resolveCustomGain(const std::string& customGain, const MeshLengths& mesh,
                       const Eigen::MatrixXd& samples, TransferFunctionOptions& transfer,
                       double& featureSize) {
    if (samples.rows() > 0) {
        const Equalizer equalizer = equalizerOf(samples, featureSize);
        transfer.type = FilterType::Custom;
        transfer.custom = equalizer;
        featureSize = equalizer.middleSize();
        return;
    }
    if (transfer.type != FilterType::Custom) return;
    const CustomGain custom = parseGain(customGain, cutoffFrequency(featureSize), mesh);
    transfer.custom = custom.gain;
    featureSize = 2.0 * kPi / custom.cutoff;
}

std::string nameOf(FilterType type) {
    Fields<TransferCall<TransferOptions>> fields;
    addTransferFields(fields);
    return fields.front().choices[static_cast<std::size_t>(type)];
}

double featureSizeOf(const MeshLengths& mesh) {
    return defaultFeatureSize(mesh.meanEdge, mesh.surfaceDiagonal);
}

}  // namespace spectral
