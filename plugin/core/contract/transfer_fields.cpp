#include "core/contract/transfer_fields.h"

#include "core/support/frequency.h"
#include "core/support/types.h"
#include "core/transfer/custom_gain.h"

namespace spectral {

void resolveCustomGain(TransferCall& call, const MeshLengths& mesh) {
    if (call.transfer.type != FilterType::Custom) return;
    const CustomGain custom = parseGain(call.customGain, cutoffFrequency(call.featureSize), mesh);
    call.transfer.custom = custom.gain;
    call.featureSize = 2.0 * kPi / custom.cutoff;
}

std::string nameOf(FilterType type) {
    Fields<TransferCall> fields;
    addTransferFields(fields);
    return fields.front().choices[static_cast<std::size_t>(type)];
}

double featureSizeOf(const MeshLengths& mesh) {
    return defaultFeatureSize(mesh.meanEdge, mesh.surfaceDiagonal);
}

}  // namespace spectral
