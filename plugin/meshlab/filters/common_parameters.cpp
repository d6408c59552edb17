#include "meshlab/filters/common_parameters.h"

#include <common/parameters/rich_parameters.h>

#include "core/laplacian/frequency.h"
#include "core/mesh/measures.h"
#include "meshlab/mesh_conversion.h"

RichPercentage featureSizeParameter(const MeshModel& mesh, const QString& help) {
    const Scalarm diagonal = mesh.cm.bbox.Diag();
    const MeshMatrices matrices = toMatrices(mesh.cm);
    const double meanEdge = spectral::meanEdgeLength(matrices.V, matrices.F);
    return {"feature_size",
            static_cast<Scalarm>(spectral::defaultFeatureSize(meanEdge, diagonal)),
            0,
            diagonal,
            "Feature size",
            help};
}

double featureSize(const RichParameterList& parameters) {
    return parameters.getAbsPerc("feature_size");
}

RichEnum laplacianParameter(const QString& help) {
    // In the order of the core's enumeration.
    return {"laplacian",
            static_cast<int>(spectral::LaplacianKind::IntrinsicDelaunay),
            {"intrinsic delaunay", "cotangent"},
            "Laplacian",
            help,
            true};
}

spectral::LaplacianKind laplacianKind(const RichParameterList& parameters) {
    return static_cast<spectral::LaplacianKind>(parameters.getEnum("laplacian"));
}

RichEnum boundaryParameter(const QString& help) {
    // In the order of the core's enumeration.
    return {
        "boundary", static_cast<int>(spectral::Boundary::Free), {"free", "fixed"}, "Boundary", help,
        true};
}

spectral::Boundary boundaryCondition(const RichParameterList& parameters) {
    return static_cast<spectral::Boundary>(parameters.getEnum("boundary"));
}
