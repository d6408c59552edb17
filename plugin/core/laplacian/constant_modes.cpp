#include "core/laplacian/constant_modes.h"

#include <cmath>

#include "core/support/threads.h"

namespace spectral {

ConstantModes::ConstantModes(const Components& components, const Eigen::VectorXd& D)
    : label_(components.label), mass_(Eigen::VectorXd::Zero(components.count)) {
    isWhole_ = count() == 1 && label_->minCoeff() == 0;
    if (isWhole_)
        mass_[0] = D.sum();
    else
        for (Index i = 0; i < D.size(); ++i)
            if (label_[i] >= 0) mass_[label_[i]] += D[i];
}

Eigen::MatrixXd ConstantModes::means(const Eigen::VectorXd& D,
                                     const Eigen::Ref<const Eigen::MatrixXd>& X) const {
    if (isWhole_) return D.transpose() * X / mass_[0];
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(mass_.size(), X.cols());
    for (Index c = 0; c < X.cols(); ++c)
        for (Index i = 0; i < X.rows(); ++i)
            if (label_[i] >= 0) sums(label_[i], c) += D[i] * X(i, c);
    return mass_.cwiseInverse().asDiagonal() * sums;
}

void ConstantModes::add(const Eigen::MatrixXd& means, Eigen::Ref<Eigen::MatrixXd> X) const {
    parallelRows(X.rows(), [&](Index begin, Index end) {
        if (isWhole_) {
            X.middleRows(begin, end - begin).rowwise() += means.row(0);
            return;
        }
        for (Index c = 0; c < X.cols(); ++c)
            for (Index i = begin; i < end; ++i)
                if (label_[i] >= 0) X(i, c) += means(label_[i], c);
    });
}

Eigen::MatrixXd ConstantModes::orthonormal() const {
    Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(label_->size(), mass_.size());
    for (Index i = 0; i < label_->size(); ++i)
        if (label_[i] >= 0) modes(i, label_[i]) = 1.0 / std::sqrt(mass_[label_[i]]);
    return modes;
}

}  // namespace spectral
