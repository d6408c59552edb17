#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/laplacian/interior.h"
#include "core/laplacian/vertex_weight.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/support/progress.h"
#include "core/transfer/equalizer.h"

namespace spectral {

struct BandOptions {
    double smallestSize = 0.0;  ///< Of the equalizer, length units, > 0.
    int octaves = 0;            ///< Number of its gains.
    Boundary boundary = Boundary::Free;
    WeightOptions part;
};

/// A shape in bands of frequencies, for previews of an equalizer: with other gains, it is another
/// sum of the same bands.
///
/// That is the equalizer in one step, on the Laplacian of the input: near to the limit of many
/// steps for small changes, and a first impression of large ones.
class EqualizerBands {
  public:
    /// @throws Error  with code OutOfMemory when the bands would take too much of it.
    /// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
    EqualizerBands(const Vertices& V, const Faces& F, const BandOptions& options,
                   const Progress& progress);

    /// The displacement of each row of surface().X.
    Vertices displacement(const Equalizer& gain) const;

    const Surface& surface() const { return surface_; }

    /// Bytes that the bands of n vertices take.
    static double bytes(Index n, int octaves);

  private:
    Surface surface_;
    Components components_;
    std::vector<double> centres_;         // frequencies, descending
    std::vector<Eigen::MatrixXf> bands_;  // weighted, in single precision: for the eye
};

}  // namespace spectral
