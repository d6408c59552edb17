#include "components.h"

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace spectral {

namespace {

/// Union-find with path halving.
class DisjointSets {
  public:
    explicit DisjointSets(Index size) : parent_(static_cast<std::size_t>(size)) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    int find(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    // The smaller index becomes the root, so that labels ascend with the first vertex.
    void unite(int i, int j) {
        i = find(i);
        j = find(j);
        if (i > j) std::swap(i, j);
        parent_[j] = i;
    }

  private:
    std::vector<int> parent_;
};

}  // namespace

Components connectedComponents(const Faces& F, Index vertexCount) {
    DisjointSets sets(vertexCount);
    for (Index t = 0; t < F.rows(); ++t) {
        sets.unite(F(t, 0), F(t, 1));
        sets.unite(F(t, 0), F(t, 2));
    }
    Components components{Eigen::VectorXi(vertexCount), 0};
    for (int i = 0; i < vertexCount; ++i) {
        const int root = sets.find(i);
        components.label[i] = root == i ? components.count++ : components.label[root];
    }
    return components;
}

ConstantModes::ConstantModes(const Components& components, const Eigen::VectorXd& D)
    : label_(components.label), D_(D), mass_(Eigen::VectorXd::Zero(components.count)) {
    for (Index i = 0; i < D.size(); ++i)
        if (label_[i] >= 0) mass_[label_[i]] += D[i];
    isWhole_ = count() == 1 && label_.minCoeff() == 0;
}

Eigen::MatrixXd ConstantModes::means(const Eigen::Ref<const Eigen::MatrixXd>& X) const {
    if (isWhole_) return D_.transpose() * X / mass_[0];
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(mass_.size(), X.cols());
    for (Index c = 0; c < X.cols(); ++c)
        for (Index i = 0; i < X.rows(); ++i)
            if (label_[i] >= 0) sums(label_[i], c) += D_[i] * X(i, c);
    return mass_.cwiseInverse().asDiagonal() * sums;
}

void ConstantModes::add(const Eigen::MatrixXd& means, Eigen::Ref<Eigen::MatrixXd> X) const {
    if (isWhole_) {
        X.rowwise() += means.row(0);
        return;
    }
    for (Index c = 0; c < X.cols(); ++c)
        for (Index i = 0; i < X.rows(); ++i)
            if (label_[i] >= 0) X(i, c) += means(label_[i], c);
}

Eigen::MatrixXd ConstantModes::orthonormal() const {
    Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(label_.size(), mass_.size());
    for (Index i = 0; i < label_.size(); ++i)
        if (label_[i] >= 0) modes(i, label_[i]) = 1.0 / std::sqrt(mass_[label_[i]]);
    return modes;
}

}  // namespace spectral
