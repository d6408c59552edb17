// Compiled once for each instruction set, with SPECTRAL_PRODUCTS for the name of the result. All of
// Eigen is then in a namespace of that name, too (-DEigen=...): its templates are compiled with
// other instructions here than elsewhere, and the linker must not take the one for the other.
#include "dense_products.h"

#include <Eigen/Core>

namespace spectral {

namespace {

using Matrix = Eigen::Map<Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;
using Size = std::ptrdiff_t;

void transposedProduct(const double* A, Size strideA, const double* B, Size strideB, double* C,
                       Size strideC, Size n, Size p, Size q) {
    Matrix(C, p, q, Eigen::OuterStride<>(strideC)).noalias() =
        ConstMatrix(A, n, p, Eigen::OuterStride<>(strideA)).transpose() *
        ConstMatrix(B, n, q, Eigen::OuterStride<>(strideB));
}

void product(const double* A, Size strideA, const double* B, Size strideB, double* C, Size strideC,
             Size n, Size p, Size q) {
    Matrix(C, n, q, Eigen::OuterStride<>(strideC)).noalias() =
        ConstMatrix(A, n, p, Eigen::OuterStride<>(strideA)) *
        ConstMatrix(B, p, q, Eigen::OuterStride<>(strideB));
}

}  // namespace

extern const DenseProducts SPECTRAL_PRODUCTS;
const DenseProducts SPECTRAL_PRODUCTS{transposedProduct, product};

}  // namespace spectral
