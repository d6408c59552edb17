#include "core/laplacian/interior.h"

#include <algorithm>
#include <utility>

#include "core/mesh/sides.h"

namespace spectral {

std::vector<bool> boundaryVertices(const Faces& F, Index vertexCount) {
    std::vector<bool> onBoundary(static_cast<std::size_t>(vertexCount), false);
    SidesByEdge(F).forEachEdge([&](auto first, auto end) {
        if (end - first == 1) onBoundary[first->low] = onBoundary[first->high] = true;
    });
    return onBoundary;
}

std::vector<bool> fixedVerticesOf(const Faces& F, Index vertexCount, Boundary boundary) {
    if (boundary == Boundary::Fixed) return boundaryVertices(F, vertexCount);
    return std::vector<bool>(static_cast<std::size_t>(vertexCount), false);
}

Interior::Interior(const Faces& F, Components components, Boundary boundary)
    : Interior(components, fixedVerticesOf(F, components.label->size(), boundary)) {}

Interior::Interior(Components components, const std::vector<bool>& fixed)
    : surfaceComponents_(std::move(components)) {
    const Eigen::VectorXi& label = *surfaceComponents_.label;
    size_ = label.size() - std::count(fixed.begin(), fixed.end(), true);
    if (isWhole()) {
        components_ = surfaceComponents_;
        return;
    }
    std::vector<bool> hasFixed(static_cast<std::size_t>(surfaceComponents_.count), false);
    for (Index i = 0; i < label.size(); ++i) {
        if (fixed[i])
            hasFixed[label[i]] = true;
        else
            vertex_.push_back(i);
    }

    std::vector<int> number(hasFixed.size(), -1);
    for (std::size_t c = 0; c < hasFixed.size(); ++c)
        if (!hasFixed[c]) number[c] = components_.count++;
    Eigen::VectorXi inside(size());
    for (Index i = 0; i < size(); ++i) inside[i] = number[label[vertex_[i]]];
    components_.label = std::move(inside);
}

Laplacian Interior::restricted(const Laplacian& surface) const {
    if (isWhole()) return surface;
    std::vector<int> row(static_cast<std::size_t>(surface.D.size()), -1);
    for (Index i = 0; i < size(); ++i) row[vertex_[i]] = static_cast<int>(i);

    Laplacian interior{SparseMatrix(size(), size()), restricted(surface.D), {}};
    interior.constants = ConstantModes(components_, interior.D);
    interior.W.reserve(surface.W.nonZeros());
    for (Index j = 0; j < size(); ++j) {
        interior.W.startVec(j);
        for (SparseMatrix::InnerIterator entry(surface.W, vertex_[j]); entry; ++entry)
            if (row[entry.row()] >= 0) interior.W.insertBack(row[entry.row()], j) = entry.value();
    }
    interior.W.finalize();
    return interior;
}

Eigen::MatrixXd Interior::restricted(const Eigen::MatrixXd& X) const {
    if (isWhole()) return X;
    Eigen::MatrixXd rows(size(), X.cols());
    for (Index i = 0; i < size(); ++i) rows.row(i) = X.row(vertex_[i]);
    return rows;
}

}  // namespace spectral
