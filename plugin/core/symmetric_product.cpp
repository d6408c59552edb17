#include "symmetric_product.h"

#include "sparse_products.h"

namespace spectral {

namespace {

SymmetricSparse inMemory(const SparseMatrix& W) {
    return {W.rows(), W.outerIndexPtr(), W.innerIndexPtr(), W.valuePtr()};
}

}  // namespace

Eigen::MatrixXd symmetricProduct(const SparseMatrix& W,
                                 const Eigen::Ref<const Eigen::MatrixXd>& S) {
    Eigen::MatrixXd WS(S.rows(), S.cols());
    sparseProducts().product(inMemory(W), S.data(), S.outerStride(), S.cols(), WS.data(),
                             WS.rows());
    return WS;
}

Eigen::VectorXd squaredResiduals(const Laplacian& laplacian,
                                 const Eigen::Ref<const Eigen::MatrixXd>& S,
                                 const Eigen::Ref<const Eigen::VectorXd>& lambda) {
    Eigen::VectorXd squares(S.cols());
    sparseProducts().squaredResiduals(inMemory(laplacian.W), laplacian.D.data(), S.data(),
                                      S.outerStride(), S.cols(), lambda.data(), squares.data());
    return squares;
}

}  // namespace spectral
