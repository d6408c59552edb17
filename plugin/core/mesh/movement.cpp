#include "core/mesh/movement.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/measures.h"

namespace spectral {

Movement movementOf(const Vertices& X, const Faces& F, const Vertices& displacement,
                    const Eigen::VectorXd& weight, const PreservedVolumes& volumes) {
    const Eigen::VectorXd squares = displacement.rowwise().squaredNorm();
    Movement movement;
    movement.maxDisplacement = std::sqrt(squares.maxCoeff());
    movement.rmsDisplacement = std::sqrt(squares.dot(weight / weight.sum()));
    movement.meanDisplacement = squares.cwiseSqrt().dot(weight / weight.sum());
    movement.volumeBefore = signedVolume(X, F);
    movement.volumeAfter = signedVolume(X + displacement, F);
    movement.hasVolume = enclosesVolume(X, F);
    movement.volumes = volumes;
    return movement;
}

double largestAtSeams(const Vertices& V, const Vertices& moved, const Surface& surface) {
    double largest = 0.0;
    for (const auto& [vertex, row] : surface.copies)
        for (const Index i : {vertex, surface.vertex[row]})
            largest = std::max(largest, (moved.row(i) - V.row(i)).norm());
    return largest;
}

}  // namespace spectral
