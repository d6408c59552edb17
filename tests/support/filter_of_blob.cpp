#include "support/filter_of_blob.h"

#include "core/laplacian/interior.h"
#include "core/mesh/mesh.h"
#include "core/support/frequency.h"
#include "core/transfer/transfer_function.h"
#include "support/shapes.h"

namespace spectral::testing {

FilterOfBlob::FilterOfBlob(const TransferFunctionOptions& options, double featureSize,
                           BasisUpdate update)
    : surface(surfaceOf(blob().V, blob().F)),
      interior(surface.F, connectedComponents(surface.F, surface.X.rows()), Boundary::Free),
      F(options, cutoffFrequency(featureSize)),
      laplacians(surface, interior.surfaceComponents(), LaplacianKind::IntrinsicDelaunay, update) {
    evaluation.accuracy = 1e-9;
}

TransferFunctionOptions boost() {
    TransferFunctionOptions options;
    options.type = FilterType::BandPass;
    options.stopGain = 1.0;
    options.passGain = 2.0;
    return options;
}

}  // namespace spectral::testing
