#include "support/geometry_spectra.h"

#include <gtest/gtest.h>

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

void expectWhatAllEigenvectorsSay(const Mesh& mesh, Boundary boundary) {
    const GeometrySpectrum dense = spectrumOf(mesh, static_cast<int>(mesh.V.rows()), boundary);
    EXPECT_LT(dense.mismatch, 1e-9);  // the residuals of the harmonics alone
    EXPECT_NEAR(dense.amplitudes.squaredNorm() * dense.area / dense.totalEnergy, 1.0, 1e-12);
    for (const int basisSize : {0, 4, 20, 100}) {
        const GeometrySpectrum spectrum = spectrumOf(mesh, basisSize, boundary);
        ASSERT_EQ(spectrum.octaveEnergies.size(), dense.octaveEnergies.size());
        for (Index j = 0; j < dense.octaveEnergies.size(); ++j)
            EXPECT_NEAR(spectrum.octaveEnergies[j] / dense.octaveEnergies[j], 1.0, 1e-2)
                << "basis " << basisSize << ", octave " << j;
        const Index k = spectrum.frequencies.size();
        ASSERT_GE(k, basisSize);
        if (k == 0) continue;
        EXPECT_LT((spectrum.frequencies - dense.frequencies.head(k)).cwiseAbs().maxCoeff(),
                  1e-7 * dense.frequencies[k - 1]);
    }
}

}  // namespace spectral::testing
