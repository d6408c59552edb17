#include "symmetric_product.h"

#include "sparse_products.h"

namespace spectral {

Eigen::MatrixXd symmetricProduct(const SparseMatrix& W,
                                 const Eigen::Ref<const Eigen::MatrixXd>& S) {
    Eigen::MatrixXd WS(S.rows(), S.cols());
    const SymmetricSparse matrix{W.rows(), W.outerIndexPtr(), W.innerIndexPtr(), W.valuePtr()};
    sparseProducts().product(matrix, S.data(), S.outerStride(), S.cols(), WS.data(), WS.rows());
    return WS;
}

}  // namespace spectral
