#pragma once

#include <string>

#include "core/contract/filter.h"
#include "core/contract/table.h"
#include "core/support/errors.h"

namespace spectral {

// Parameters that several filters share, with the same names and defaults.

/// Field `laplacian`.
template <class Call, class At>
Field<Call> laplacianField(At at) {
    return field<Call>(
               at, "laplacian", "Laplacian",
               "How the frequencies of the surface are measured. *intrinsic delaunay* works "
               "on any triangles, including slivers, holes, duplicate or intersecting "
               "sheets, and is stable for strong filters. *cotangent* is the formula of the "
               "paper; no triangle may have zero area. *uniform* uses the connectivity "
               "only, as if the vertices were evenly spaced: for noise that differs from "
               "vertex to vertex.")
        .of({"intrinsic delaunay", "cotangent", "uniform"})
        .advanced();
}

/// Field `boundary`. @param help  describes the effect of each choice.
template <class Call, class At>
Field<Call> boundaryField(At at, const std::string& help) {
    return field<Call>(at, "boundary", "Boundary",
                       ("The boundary of an open surface, holes included. " + help).c_str())
        .of({"free", "fixed"})
        .advanced();
}

/// Field `max_displacement`.
template <class Call, class At>
Field<Call> maxDisplacementField(At at) {
    return field<Call>(at, "max_displacement", "Largest displacement",
                       "No vertex moves farther than this. Around vertices that would, the "
                       "surface moves less, too, so that no ridge is left; the report says on "
                       "how much of it. The default: no bound.")
        .in("length")
        .length("auto", nullptr, "0: no bound")
        .advanced();
}

enum class Weight { None, VertexQuality };

/// Field `weight`. @param help  what the vertex quality is a factor on.
template <class Call, class At>
Field<Call> weightField(At at, const std::string& help) {
    return field<Call>(at, "weight", "Weight", ("*vertex quality*: " + help).c_str())
        .of({"none", "vertex quality"})
        .advanced();
}

/// The vertex quality, if it is chosen; else no rows.
/// @throws InvalidOption  when the mesh has none.
inline Eigen::VectorXd weightOf(Weight weight, const FilterInput& input) {
    if (weight == Weight::None) return {};
    if (input.values.rows() == 0)
        throw InvalidOption(
            "weight = vertex quality: the mesh has no vertex quality; compute one, or choose "
            "weight = none");
    return input.values.col(0);
}

/// Field `selected`, whose default is for hosts: on if any faces are selected, where they can be.
/// @param width  distance within which the filter fades out around the selection, in words.
template <class Call, class At>
Field<Call> selectedField(At at, const std::string& width = "about a feature size") {
    return field<Call>(
        at, "selected", "Only the selection",
        ("Filter only the selected faces and vertices. Around them the filter fades out within " +
         width + ", so that no crease is left; everything beyond is unchanged.")
            .c_str());
}

}  // namespace spectral
