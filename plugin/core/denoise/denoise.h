#pragma once

#include "core/laplacian/interior.h"
#include "core/mesh/mesh.h"
#include "core/mesh/volume.h"
#include "core/support/progress.h"

namespace spectral {

struct DenoiseOptions {
    double strength = 1.0;     ///< Factor of the noise height that is removed, >= 0.
    double noiseHeight = 0.0;  ///< Length units; 0: estimated (noise_height.h).
    bool keepCreases = true;   ///< Else smooths across them, too.
    Boundary boundary = Boundary::Fixed;
};

struct DenoiseResult {
    Vertices V;  ///< The denoised positions; unreferenced vertices stay where they are.

    double estimatedHeight = 0.0;  ///< Of the noise in V (noise_height.h), length units.
    double noiseHeight = 0.0;      ///< That was removed, times the strength, length units.
    double meanEdge = 0.0;         ///< Without the noise, length units.
    int rounds = 0;                ///< Weak parts of the filter of the normals; 0: no noise.
    double maxDisplacement = 0.0;  ///< Largest vertex displacement, length units.
    double rmsDisplacement = 0.0;  ///< Root mean square over the vertices.
    double volumeBefore = 0.0, volumeAfter = 0.0;  ///< Signed; a volume for closed meshes only.
    PreservedVolumes volumes;                      ///< Of the closed components.
    int components = 0;                            ///< Connected components of the surface.
    int unreferencedVertices = 0;                  ///< Vertices of no triangle, unchanged.
    int fixedVertices = 0;                         ///< Vertices on a fixed boundary, unchanged.
};

/// Removes noise that differs from vertex to vertex, and chooses how from the noise it finds.
///
/// The signal is the field of the face normals, the operator the Laplacian of the graph of the
/// faces, in which faces across a crease hardly mix. Its low-pass is applied in weak parts, with
/// the operator taken anew from the shape after each, as in Kovnatsky et al. 2012, Eq. 11
/// (normal_filter.h); the vertices then follow the normals (vertex_update.h). The filter stops when
/// the vertices have moved as far as the noise had moved them, by their median: Morozov's
/// discrepancy principle. Vertices move along normals alone, but for those of folded faces
/// (unfold.h), by at most three times the noise or 0.3 mean edges, and closed components keep
/// their volume.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology and orientation.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
DenoiseResult denoise(const Vertices& V, const Faces& F, const DenoiseOptions& options,
                      const Progress& progress = {});

}  // namespace spectral
