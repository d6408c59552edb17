#pragma once

#include <vector>

#include "core/laplacian/interior.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/mesh/volume.h"
#include "core/noise/diagnosis.h"
#include "core/support/progress.h"

namespace spectral {

struct DenoiseOptions {
    double strength = 1.0;     ///< Part of the displacement to make, or, above 1, factor of the
                               ///< noise height that is removed; >= 0.
    double noiseHeight = 0.0;  ///< Length units; 0: measured (diagnosis.h).
    double noiseSize = 0.0;    ///< Correlation length, length units; 0: measured.
    bool keepCreases = true;   ///< Else smooths across them, too.
    Boundary boundary = Boundary::Free;
    std::vector<bool> selected;  ///< n: what to denoise; empty: everything.
};

struct DenoiseResult : SurfaceCounts {
    Vertices V;  ///< The denoised positions; unreferenced vertices stay where they are.

    Diagnosis diagnosis;
    double noiseHeight = 0.0;      ///< The height it removed, length units; 0: none.
    double noiseSize = 0.0;        ///< Its correlation length, length units; 0: of single vertices.
    int rounds = 0;                ///< Weak parts of the filter, or linear steps; 0: none.
    bool isCrumpled = false;       ///< Not removed: that would have folded the surface.
    double maxDisplacement = 0.0;  ///< Largest vertex displacement, length units.
    double rmsDisplacement = 0.0;  ///< Root mean square over the vertices.
    double volumeBefore = 0.0, volumeAfter = 0.0;  ///< Signed; a volume where there is one.
    bool hasVolume = false;                        ///< Whether the surface encloses one.
    PreservedVolumes volumes;                      ///< Of the closed components.
};

/// Removes noise, and chooses how from the noise it finds.
///
/// The signal is the field of the face normals, the operator the Laplacian of the graph of the
/// faces, in which faces across a crease hardly mix. Its low-pass is applied in weak parts, with
/// the operator taken anew from the shape after each, as in Kovnatsky et al. 2012, Eq. 11
/// (normal_filter.h); the vertices then follow the normals (vertex_update.h). The stages: what kind
/// of noise it is (diagnosis.h), spikes out (spikes.h), the rest of the noise out, as far as it
/// explains (removal.h), unless that would crumple the surface (crumpling.h); and closed components
/// get their volume back. Around a selection all this fades out within four edges, and only what is
/// selected is measured.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology and orientation.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
DenoiseResult denoise(const Vertices& V, const Faces& F, const DenoiseOptions& options,
                      const Progress& progress = {});

}  // namespace spectral
