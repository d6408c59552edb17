#include "support/geometry_spectra.h"

#include "core/laplacian/interior.h"

namespace spectral::testing {

SpectrumOptions withBasis(int basisSize, LaplacianKind kind) {
    SpectrumOptions options;
    options.basisSize = basisSize;
    options.laplacian = kind;
    return options;
}

GeometrySpectrum spectrumOf(const Mesh& mesh, int basisSize, Boundary boundary) {
    SpectrumOptions options = withBasis(basisSize);
    options.boundary = boundary;
    return geometrySpectrum(mesh.V, mesh.F, options);
}

}  // namespace spectral::testing
