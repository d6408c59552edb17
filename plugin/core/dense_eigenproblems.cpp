// Compiled once for each instruction set, as dense_products.cpp is: see there.
#include "dense_eigenproblems.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>

namespace spectral {

namespace {

using Size = std::ptrdiff_t;
using Matrix = Eigen::Map<Eigen::MatrixXd>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd>;
using Vector = Eigen::Map<Eigen::VectorXd>;

bool store(const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>& solver, Size m, double* values,
           double* Z) {
    if (solver.info() != Eigen::Success) return false;
    Vector(values, m) = solver.eigenvalues();
    Matrix(Z, m, m) = solver.eigenvectors();
    return true;
}

bool symmetric(const double* A, Size m, double* values, double* Z) {
    return store(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(ConstMatrix(A, m, m)), m, values,
                 Z);
}

bool generalized(const double* A, const double* B, Size m, double* values, double* Z) {
    // With B = L L^T and Y = L^T Z: L^-1 A L^-T Y = Y diag(values). Eigen's own solver for that
    // does not say whether there is an L.
    const Eigen::LLT<Eigen::MatrixXd> llt(ConstMatrix(B, m, m));
    if (llt.info() != Eigen::Success) return false;
    // Of a column that others make up rounding leaves a part that may be positive.
    const double rounding = static_cast<double>(m) * std::numeric_limits<double>::epsilon();
    const auto pivots = llt.matrixLLT().diagonal().array().square();
    if ((pivots <= rounding * ConstMatrix(B, m, m).diagonal().array()).any()) return false;
    Eigen::MatrixXd C = ConstMatrix(A, m, m).selfadjointView<Eigen::Lower>();
    llt.matrixL().solveInPlace<Eigen::OnTheLeft>(C);
    llt.matrixU().solveInPlace<Eigen::OnTheRight>(C);
    if (!store(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(C), m, values, Z)) return false;
    Matrix Y(Z, m, m);
    llt.matrixU().solveInPlace(Y);
    return Y.allFinite();
}

}  // namespace

namespace SPECTRAL_INSTRUCTIONS {
extern const DenseEigenproblems denseEigenproblems;
const DenseEigenproblems denseEigenproblems{symmetric, generalized};
}  // namespace SPECTRAL_INSTRUCTIONS

}  // namespace spectral
