#pragma once

#include "fuzz/contract.h"

namespace spectral::fuzz {

// Compare a result with all eigenvectors of the same W and D, where there is one Laplacian and not
// too many vertices.

/// A filter of one step, where it claims to have reached its accuracy.
void compareWithDense(const testing::Mesh& mesh, const FilterOptions& options,
                      const FilterResult& result, Verdict& verdict);

void compareWithDense(const testing::Mesh& mesh, const ArtefactOptions& options,
                      const Artefacts& result, Verdict& verdict);

/// Eigenvalues; and residuals and orthogonality, which need no reference.
void compareWithDense(const testing::Mesh& mesh, const HarmonicsOptions& options,
                      const ManifoldHarmonics& result, Verdict& verdict);

/// Total energy, and its share in every octave.
void compareWithDense(const testing::Mesh& mesh, const SpectrumOptions& options,
                      const GeometrySpectrum& result, Verdict& verdict);

}  // namespace spectral::fuzz
