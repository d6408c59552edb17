// Compiled once for each instruction set, with SPECTRAL_INSTRUCTIONS for the namespace of the
// result. All of Eigen is then in a namespace of its own, too (-DEigen=...): its templates are
// compiled with other instructions here than elsewhere, and the linker must not take the one for
// the other.
#include "dense_products.h"

#include <Eigen/Core>
#include <algorithm>

namespace spectral {

namespace {

using Matrix = Eigen::Map<Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;
using Size = std::ptrdiff_t;

/// Rows that one register holds, with room for it.
using Lane = Eigen::Array<double, 4, 1>;
constexpr Size kLane = 4;

Lane lane(const double* at) { return Eigen::Map<const Lane>(at); }

/// C = A^T B for P and Q columns, so few that all of C is in registers.
template <int P, int Q>
void transposedProductOfFew(const double* A, Size strideA, const double* B, Size strideB, double* C,
                            Size strideC, Size n) {
    Lane sum[P][Q];
    for (auto& row : sum)
        for (Lane& entry : row) entry.setZero();
    Size r = 0;
    for (; r + kLane <= n; r += kLane)
        for (int i = 0; i < P; ++i) {
            const Lane a = lane(A + i * strideA + r);
            for (int j = 0; j < Q; ++j) sum[i][j] += a * lane(B + j * strideB + r);
        }
    for (int i = 0; i < P; ++i)
        for (int j = 0; j < Q; ++j) {
            double total = sum[i][j].sum();
            for (Size rest = r; rest < n; ++rest)
                total += A[i * strideA + rest] * B[j * strideB + rest];
            C[i + j * strideC] = total;
        }
}

/// C += A B for P columns of A and Q of C.
template <int P, int Q>
void addProductOfFew(const double* A, Size strideA, const double* B, Size strideB, double* C,
                     Size strideC, Size n) {
    double b[P][Q];
    for (int i = 0; i < P; ++i)
        for (int j = 0; j < Q; ++j) b[i][j] = B[i + j * strideB];
    Size r = 0;
    for (; r + kLane <= n; r += kLane) {
        Lane a[P];
        for (int i = 0; i < P; ++i) a[i] = lane(A + i * strideA + r);
        for (int j = 0; j < Q; ++j) {
            Lane c = lane(C + j * strideC + r);
            for (int i = 0; i < P; ++i) c += b[i][j] * a[i];
            Eigen::Map<Lane>(C + j * strideC + r) = c;
        }
    }
    for (; r < n; ++r)
        for (int j = 0; j < Q; ++j)
            for (int i = 0; i < P; ++i) C[j * strideC + r] += A[i * strideA + r] * b[i][j];
}

/// The general product packs A first, which for a few columns of B takes longer than to multiply.
template <int Q>
void transposedProductWithFew(const double* A, Size strideA, const double* B, Size strideB,
                              double* C, Size strideC, Size n, Size p) {
    constexpr int kColumns = Q <= 2 ? 4 : 2;
    Size i = 0;
    for (; i + kColumns <= p; i += kColumns)
        transposedProductOfFew<kColumns, Q>(A + i * strideA, strideA, B, strideB, C + i, strideC,
                                            n);
    for (; i < p; ++i)
        transposedProductOfFew<1, Q>(A + i * strideA, strideA, B, strideB, C + i, strideC, n);
}

template <int Q>
void productWithFew(const double* A, Size strideA, const double* B, Size strideB, double* C,
                    Size strideC, Size n, Size p) {
    for (int j = 0; j < Q; ++j) std::fill_n(C + j * strideC, n, 0.0);
    Size i = 0;
    for (; i + 4 <= p; i += 4)
        addProductOfFew<4, Q>(A + i * strideA, strideA, B + i, strideB, C, strideC, n);
    for (; i < p; ++i)
        addProductOfFew<1, Q>(A + i * strideA, strideA, B + i, strideB, C, strideC, n);
}

void transposedProduct(const double* A, Size strideA, const double* B, Size strideB, double* C,
                       Size strideC, Size n, Size p, Size q) {
    switch (q) {
        case 1: return transposedProductWithFew<1>(A, strideA, B, strideB, C, strideC, n, p);
        case 2: return transposedProductWithFew<2>(A, strideA, B, strideB, C, strideC, n, p);
        case 3: return transposedProductWithFew<3>(A, strideA, B, strideB, C, strideC, n, p);
        case 4: return transposedProductWithFew<4>(A, strideA, B, strideB, C, strideC, n, p);
        default: break;
    }
    Matrix(C, p, q, Eigen::OuterStride<>(strideC)).noalias() =
        ConstMatrix(A, n, p, Eigen::OuterStride<>(strideA)).transpose() *
        ConstMatrix(B, n, q, Eigen::OuterStride<>(strideB));
}

void upperTransposedProduct(const double* A, Size strideA, const double* B, Size strideB, double* C,
                            Size strideC, Size n, Size m) {
    Matrix(C, m, m, Eigen::OuterStride<>(strideC)).triangularView<Eigen::Upper>() =
        ConstMatrix(A, n, m, Eigen::OuterStride<>(strideA)).transpose() *
        ConstMatrix(B, n, m, Eigen::OuterStride<>(strideB));
}

void product(const double* A, Size strideA, const double* B, Size strideB, double* C, Size strideC,
             Size n, Size p, Size q) {
    switch (q) {
        case 1: return productWithFew<1>(A, strideA, B, strideB, C, strideC, n, p);
        case 2: return productWithFew<2>(A, strideA, B, strideB, C, strideC, n, p);
        case 3: return productWithFew<3>(A, strideA, B, strideB, C, strideC, n, p);
        case 4: return productWithFew<4>(A, strideA, B, strideB, C, strideC, n, p);
        default: break;
    }
    Matrix(C, n, q, Eigen::OuterStride<>(strideC)).noalias() =
        ConstMatrix(A, n, p, Eigen::OuterStride<>(strideA)) *
        ConstMatrix(B, p, q, Eigen::OuterStride<>(strideB));
}

}  // namespace

namespace SPECTRAL_INSTRUCTIONS {
extern const DenseProducts denseProducts;
const DenseProducts denseProducts{transposedProduct, upperTransposedProduct, product};
}  // namespace SPECTRAL_INSTRUCTIONS

}  // namespace spectral
