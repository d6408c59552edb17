#pragma once

#include "core/graph/face_graph.h"
#include "core/mesh/mesh.h"

namespace spectral {

/// What differs from face to face with the noise.
struct FacesInNoise {
    Eigen::VectorXd time;    ///< m factors on the diffusion time, >= 0.
    Eigen::VectorXd height;  ///< m: standard deviation of the noise, mean edges.
};

struct NormalFilterOptions {
    double time = 0.0;        ///< Diffusion time t, >= 0.
    double edgeScale = 0.0;   ///< s: distance of unit normals beyond which they hardly mix, > 0.
    int blurs = 2;            ///< Number of blurs of the normals that define the weights, >= 0.
    bool useTwicing = false;  ///< F + F (1 - F) instead of F: flatter at the shape's frequencies.
    const FacesInNoise* noise = nullptr;  ///< Null: the same time for all, and no noise.
    const Points* guide = nullptr;  ///< m x 3 unit normals q that define the weights; null: those
                                    ///< of X, blurred.
    double flatness = 0.0;          ///< Added to the weights where q are alike, >= 0.
    double accuracy = 0.01;         ///< Of the equation: norm of the residual over that of M N.
};

/// The face normals of the shape X (n x 3), smoothed over the faces but not across creases:
///
///     N' = F N,  F = (M + t L)^-1 M,  scaled to length 1.
///
/// L is the Laplacian of the face graph with weights |e| / mean |e| exp(-|q_a - q_b|^2 / (2 s^2))
/// between faces a and b with common edge e, where q are the normals blurred over the neighbours. M
/// holds the square roots of the areas over the mean area, as the normal of a small face is less
/// certain. L depends on the current shape: one call is a weak part of a fractional filter
/// (Kovnatsky et al. 2012, Eq. 11) whose signal is the field of normals. Where edges are short,
/// noise tilts faces more: s^2 grows there by the amount that the height of the noise explains.
///
/// Twicing (Tukey 1977) applies F again to what it has removed, which squares the loss 1 - F: low
/// frequencies keep their detail, and hardly more of the high ones passes.
///
/// @param guess  m x 3 normals near the result, such as those of the previous round; or empty.
Points filterNormals(const FaceGraph& graph, const Points& X, const NormalFilterOptions& options,
                     const Points& guess = {});

/// The face normals of the shape X of least total variation (lagged diffusivity): the same filter
/// with weights |e| / mean |e| s / sqrt(|n_a - n_b|^2 + 0.05^2) of the last iterate n. Flat parts
/// become flat and steps stay steps, which suits noise as large as the details. M holds the areas.
///
/// @param time  strength, >= 0.
Points normalsOfLeastVariation(const FaceGraph& graph, const Points& X, double time);

}  // namespace spectral
