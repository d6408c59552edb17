#include "common_parameters.h"

#include <common/parameters/rich_parameters.h>

namespace {

/// In parts of the diagonal of the bounding box.
constexpr double kDefaultFeatureSize = 0.05;

}  // namespace

RichPercentage featureSizeParameter(const MeshModel& mesh, const QString& help) {
    const Scalarm diagonal = mesh.cm.bbox.Diag();
    return {"feature_size",
            static_cast<Scalarm>(kDefaultFeatureSize) * diagonal,
            0,
            diagonal,
            "Feature size",
            help};
}

double featureSize(const RichParameterList& parameters) {
    return parameters.getAbsPerc("feature_size");
}

RichEnum laplacianParameter(const QString& help) {
    // The order of the entries is that of the core's enumeration.
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
    // The order of the entries is that of the core's enumeration.
    return {
        "boundary", static_cast<int>(spectral::Boundary::Free), {"free", "fixed"}, "Boundary", help,
        true};
}

spectral::Boundary boundaryCondition(const RichParameterList& parameters) {
    return static_cast<spectral::Boundary>(parameters.getEnum("boundary"));
}
