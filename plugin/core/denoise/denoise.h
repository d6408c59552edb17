#pragma once

#include <vector>

#include "core/laplacian/interior.h"
#include "core/mesh/mesh.h"
#include "core/mesh/movement.h"
#include "core/mesh/surface.h"
#include "core/noise/diagnosis.h"
#include "core/support/progress.h"

namespace spectral {

struct DenoiseOptions {
    double strength = 1.0;     ///< Fraction of the displacement to apply, or, if above 1, factor on
                               ///< the noise height; >= 0, which only looks for the noise.
    double noiseHeight = 0.0;  ///< Standard deviation of the noise, length units; 0: measure it.
    Eigen::VectorXd weight;    ///< n, 0 to 1: factor on noiseHeight at each vertex; empty: 1.
    double noiseSize = 0.0;    ///< Correlation length of the noise, length units; 0: measure it.
    double maxDisplacement = 0.0;  ///< Bound on the displacement of every vertex, length units
                                   ///< (displacement_limit.h); 0: none.
    double meanEdge = 0.0;    ///< Of the surface that the mesh is a tile of, length units; 0: the
                              ///< mesh is the whole.
    bool keepCreases = true;  ///< If false, smooths across creases, too.
    Boundary boundary = Boundary::Free;
    std::vector<bool> selected;  ///< n: vertices to denoise; empty: all.
};

struct DenoiseResult : SurfaceCounts, Movement {
    Vertices V;  ///< Denoised positions; unreferenced vertices keep theirs.

    Diagnosis diagnosis;
    double noiseHeight = 0.0;  ///< Height of the removed or found noise, length units; 0: none.
    double noiseSize = 0.0;    ///< Its correlation length, length units; 0: white noise.
    Eigen::VectorXd heights;   ///< n: height of the noise at each vertex as found, or as given,
                               ///< length units; 0: none.
    int rounds = 0;            ///< Rounds of the normal filter, or linear steps; 0: none.
    bool isCrumpled = false;   ///< Nothing removed: that would have folded the surface.
};

/// Removes noise by a method that depends on the noise it finds.
///
/// The signal is the field of face normals, the operator the Laplacian of the face graph, in which
/// faces across a crease hardly mix. Its low-pass is applied in weak rounds, and the operator is
/// rebuilt from the shape after each, as in Kovnatsky et al. 2012, Eq. 11 (normal_filter.h); the
/// vertices then follow the normals (vertex_update.h).
///
/// The noise of a single scan lies along its rays: where they can be seen (scan_rays.h), vertices
/// move along them only. Those of a depth camera start at the origin of the coordinates, so that
/// the result depends on where it is.
///
/// The stages: determine the kind of noise (diagnosis.h); remove spikes (spikes.h); remove noise up
/// to its height (removal.h), unless that would crumple the surface (crumpling.h); restore the
/// volume of closed components. Around a selection the displacement fades out within four edges;
/// only selected vertices are measured.
///
/// @param V  n x 3 positions, finite.
/// @param F  m x 3 vertex indices, m >= 1; any topology and orientation.
/// @throws InvalidMesh, InvalidOption, SolverFailure, Cancelled
DenoiseResult denoise(const Vertices& V, const Faces& F, const DenoiseOptions& options,
                      const Progress& progress = {});

}  // namespace spectral
