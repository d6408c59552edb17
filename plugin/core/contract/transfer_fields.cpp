#include "core/contract/transfer_fields.h"

#include "core/support/frequency.h"
#include "core/support/types.h"
#include "core/transfer/custom_gain.h"
#include "core/transfer/sampled_gain.h"

namespace spectral {

void resolveCustomGain(const std::string& customGain, const MeshLengths& mesh,
                       const Eigen::MatrixXd& samples, TransferFunctionOptions& transfer,
                       double& featureSize) {
    if (samples.rows() > 0) {
        transfer.type = FilterType::Custom;
        transfer.custom = [gain = SampledGain(samples), cutoff = cutoffFrequency(featureSize)](
                              double omega) { return gain(omega / cutoff); };
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
