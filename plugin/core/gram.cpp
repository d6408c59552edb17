#include "gram.h"

#include "dense_products.h"

namespace spectral {

Eigen::MatrixXd innerProducts(const Eigen::Ref<const Eigen::MatrixXd>& S, const Eigen::VectorXd& D,
                              const Eigen::Ref<const Eigen::MatrixXd>& T) {
    const Eigen::MatrixXd DT = D.asDiagonal() * T;
    Eigen::MatrixXd result(S.cols(), T.cols());
    denseProducts().transposedProduct(S.data(), S.outerStride(), DT.data(), DT.rows(),
                                      result.data(), S.cols(), S.rows(), S.cols(), T.cols());
    return result;
}

void removePart(const Eigen::Ref<const Eigen::MatrixXd>& S, const Eigen::VectorXd& D,
                Eigen::Ref<Eigen::MatrixXd> T) {
    const Eigen::MatrixXd overlaps = innerProducts(S, D, T);
    Eigen::MatrixXd part(T.rows(), T.cols());
    denseProducts().product(S.data(), S.outerStride(), overlaps.data(), overlaps.rows(),
                            part.data(), part.rows(), S.rows(), S.cols(), T.cols());
    T -= part;
}

}  // namespace spectral
