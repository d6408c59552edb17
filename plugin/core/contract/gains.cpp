#include "core/contract/gains.h"

#include "core/contract/transfer_fields.h"
#include "core/support/frequency.h"

namespace spectral {

Eigen::VectorXd gainsAt(const Values& given, double featureSize, const MeshLengths& mesh,
                        const Eigen::VectorXd& w) {
    Fields<TransferCall> fields;
    addTransferFields(fields);
    TransferCall call = callOf(fields, given, mesh);
    call.featureSize = featureSize;
    const double unit = cutoffFrequency(featureSize);
    resolveCustomGain(call, mesh, {});
    const TransferFunction F(call.transfer, cutoffFrequency(call.featureSize));
    return w.unaryExpr([&](double x) { return F(x * unit); });
}

}  // namespace spectral
