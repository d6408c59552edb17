#pragma once

#include <vector>

#include "core/graph/face_graph.h"

namespace spectral {

/// Removes white noise by the polynomial of the neighbours' mean P of least estimated risk: the
/// displacement is U c, where the columns of U are (T_j(P) - 1) X along the normals, T_j are
/// Chebyshev polynomials, and
///
///     U^T U c = -height^2 tr(T(P) - 1)
///
/// (Stein's unbiased risk estimate; a linear expansion, Blu and Luisier 2007). It takes what is as
/// high as white noise at each frequency and leaves what is higher, such as ribs, whatever their
/// size: low-pass filters do not. Where noise has all directions alike, so do the displacements,
/// with coefficients of their own for those along the surface.
///
/// @param X        n x 3 positions.
/// @param mayMove  n: whether a vertex may move.
/// @param height   standard deviation of the noise, length units, > 0.
/// @return         n x 3 positions.
Points withLeastRisk(const FaceGraph& graph, const Points& X, const std::vector<bool>& mayMove,
                     double height);

}  // namespace spectral
