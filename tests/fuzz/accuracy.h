#pragma once

#include <string>
#include <utility>
#include <vector>

#include "fuzz/cases.h"

namespace spectral::fuzz {

/// How a result compares with all eigenvectors of the same W and D.
struct Accuracy {
    bool isCompared = false;  ///< A reference exists: one Laplacian, not too many vertices.
    bool isExcused = false;   ///< As in Verdict.
    std::vector<std::pair<std::string, std::string>> failures;  ///< Kind and text.
};

/// A filter of one step, where it claims to have reached its accuracy.
Accuracy accuracyOf(const testing::Mesh& mesh, const FilterOptions& options,
                    const FilterResult& result);

Accuracy accuracyOf(const testing::Mesh& mesh, const ArtefactOptions& options,
                    const Artefacts& result);

/// Eigenvalues; and residuals and orthogonality, which need no reference.
Accuracy accuracyOf(const testing::Mesh& mesh, const HarmonicsOptions& options,
                    const ManifoldHarmonics& result);

/// Total energy, and its share in every octave.
Accuracy accuracyOf(const testing::Mesh& mesh, const SpectrumOptions& options,
                    const GeometrySpectrum& result);

}  // namespace spectral::fuzz
