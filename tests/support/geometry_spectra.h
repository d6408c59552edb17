#pragma once

#include "core/analysis/geometry_spectrum.h"
#include "core/laplacian/interior.h"
#include "support/ply.h"

namespace spectral::testing {

SpectrumOptions withBasis(int basisSize, LaplacianKind kind = LaplacianKind::Cotangent);

/// With plain cotangents.
GeometrySpectrum spectrumOf(const Mesh& mesh, int basisSize, Boundary boundary = Boundary::Free);

}  // namespace spectral::testing
