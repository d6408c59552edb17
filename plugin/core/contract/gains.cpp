#include "core/contract/gains.h"

#include "core/contract/transfer_fields.h"
#include "core/support/frequency.h"

namespace spectral {

Eigen::VectorXd gainsAt(const Values& given, double featureSize, const MeshLengths& mesh,
                        const Eigen::VectorXd& w) {
    Fields<TransferCall<TransferOptions>> fields;
    addTransferFields(fields);
    TransferCall<TransferOptions> call = callOf(fields, given, mesh);
    call.featureSize = featureSize;
    const double unit = cutoffFrequency(featureSize);
    resolveCustomGain(call.customGain, mesh, {}, call.transferFunction, call.featureSize);
    const TransferFunction F(call.transferFunction, cutoffFrequency(call.featureSize));
    return w.unaryExpr([&](double x) { return F(x * unit); });
}

}  // namespace spectral
