#pragma once

#include <vector>

#include "core/analysis/form_fit.h"
#include "core/mesh/surface.h"

namespace spectral {

/// A fitted shape, and the part of a surface that follows it.
struct FormPart {
    FittedShape shape;
    Surface surface;                 ///< That part, in place; positions as of the whole.
    FittedShape::Distances heights;  ///< Of its vertices from the shape, n rows.
    int elsewhere = 0;               ///< Selected vertices of the whole that are not on it.
};

/// Fits a shape to the selected part of a surface, by its areas as seen along the shape's normals:
/// steep or overhanging places weigh no more than what they cover. What does not face along the
/// normals does not belong to it, such as the caps of a cylinder; nor what is farther from the
/// shape than the selected part by more than the whole range of its heights.
///
/// @param selected  n, at least one.
/// @param size      length over which a slope is roughness, > 0.
/// @throws InvalidOption  when there is no such shape, or about as much of the surface faces
///                        backwards, so that either side may be meant.
FormPart formPart(ShapeKind kind, Surface surface, const std::vector<bool>& selected, double size);

}  // namespace spectral
