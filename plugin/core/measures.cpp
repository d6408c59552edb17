#include "measures.h"

#include <Eigen/Geometry>

namespace spectral {

double boundingBoxDiagonal(const Vertices& V) {
    return (V.colwise().maxCoeff() - V.colwise().minCoeff()).norm();
}

double surfaceArea(const Vertices& V, const Faces& F) {
    double twiceArea = 0.0;
    for (Index t = 0; t < F.rows(); ++t) {
        const Eigen::RowVector3d a = V.row(F(t, 0)), b = V.row(F(t, 1)), c = V.row(F(t, 2));
        twiceArea += (b - a).cross(c - a).norm();
    }
    return 0.5 * twiceArea;
}

double signedVolume(const Vertices& V, const Faces& F) {
    // About the middle: far from the origin the tetrahedra would cancel each other's digits.
    const Eigen::RowVector3d o = 0.5 * (V.colwise().maxCoeff() + V.colwise().minCoeff());
    double sixfoldVolume = 0.0;
    for (Index t = 0; t < F.rows(); ++t) {
        const Eigen::RowVector3d a = V.row(F(t, 0)) - o, b = V.row(F(t, 1)) - o,
                                 c = V.row(F(t, 2)) - o;
        sixfoldVolume += a.dot(b.cross(c));
    }
    return sixfoldVolume / 6.0;
}

}  // namespace spectral
