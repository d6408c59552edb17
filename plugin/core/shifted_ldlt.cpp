#include "shifted_ldlt.h"

#include <algorithm>
#include <string>

#include "errors.h"

namespace spectral {

namespace {

constexpr int kMaxAttempts = 4;

/// Relative change of a shift that has met an eigenvalue of a leading minor.
constexpr double kNudge = 1e-7;

/// A few right-hand sides, those of a row side by side.
template <int Columns>
using Block = Eigen::Array<double, Eigen::Dynamic, Columns,
                           (Columns > 1 ? Eigen::RowMajor : Eigen::ColMajor)>;

/// A sparse lower triangular matrix with a diagonal of 1, which is not stored.
///
/// Most of its entries are in runs of columns with the same rows below them (supernodes). Several
/// columns are taken at once: each row of the right-hand side is then fetched once for all.
class UnitLower {
  public:
    explicit UnitLower(const SparseMatrix& L)
        : n_(L.rows()), start_(L.outerIndexPtr()), row_(L.innerIndexPtr()), value_(L.valuePtr()) {}

    /// Number of columns from j on, at most so many, that have the same rows below them.
    int width(Index j, int most) const {
        int width = 1;
        while (width < most && j + width < n_ && followed(j + width - 1)) ++width;
        return width;
    }

    /// The same for the columns that end before `end`.
    int widthBefore(Index end, int most) const {
        int width = 1;
        while (width < most && end - width > 0 && followed(end - width - 1)) ++width;
        return width;
    }

    /// Forward elimination by columns j to j + Width - 1.
    template <int Width, int Columns>
    void eliminate(Index j, Block<Columns>& Y) const {
        Eigen::Array<double, 1, Columns> y[Width];
        for (int i = 0; i < Width; ++i) {
            y[i] = Y.row(j + i);
            for (int k = 0; k < i; ++k) y[i] -= value_[start_[j + k] + i - k - 1] * y[k];
            Y.row(j + i) = y[i];
        }
        const Tails<Width> tails(*this, j);
        for (int p = 0; p < tails.size; ++p) {
            Eigen::Array<double, 1, Columns> z = Y.row(tails.row[p]);
            for (int k = 0; k < Width; ++k) z -= tails.value[k][p] * y[k];
            Y.row(tails.row[p]) = z;
        }
    }

    /// Back substitution by the transposes of columns j to j + Width - 1.
    template <int Width, int Columns>
    void substitute(Index j, Block<Columns>& Y) const {
        Eigen::Array<double, 1, Columns> y[Width];
        for (int i = 0; i < Width; ++i) y[i] = Y.row(j + i);
        const Tails<Width> tails(*this, j);
        for (int p = 0; p < tails.size; ++p) {
            const Eigen::Array<double, 1, Columns> z = Y.row(tails.row[p]);
            for (int k = 0; k < Width; ++k) y[k] -= tails.value[k][p] * z;
        }
        for (int i = Width - 1; i >= 0; --i) {
            for (int k = 0; k < i; ++k) y[k] -= value_[start_[j + k] + i - k - 1] * y[i];
            Y.row(j + i) = y[i];
        }
    }

  private:
    /// The rows below a group of columns, and their entries there.
    template <int Width>
    struct Tails {
        Tails(const UnitLower& L, Index j)
            : size(L.count(j + Width - 1)), row(L.row_ + L.start_[j + Width - 1]) {
            for (int k = 0; k < Width; ++k) value[k] = L.value_ + L.start_[j + k] + Width - 1 - k;
        }
        int size;
        const int* row;
        const double* value[Width];
    };

    int count(Index j) const { return start_[j + 1] - start_[j]; }

    /// Whether column j + 1 has all the rows of column j but the first, which is j + 1: that
    /// follows from their number, because what is below the first entry of a column fills that
    /// row's column.
    bool followed(Index j) const {
        return count(j) == count(j + 1) + 1 && row_[start_[j]] == j + 1;
    }

    Index n_;
    const int* start_;
    const int* row_;
    const double* value_;
};

bool samePattern(const SparseMatrix& A, const SparseMatrix& B) {
    return A.rows() == B.rows() && A.nonZeros() == B.nonZeros() &&
           std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1,
                      B.outerIndexPtr()) &&
           std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

}  // namespace

void ShiftedLdlt::factorize(const Laplacian& laplacian, double sigma) {
    if (!samePattern(shifted_, laplacian.W)) ldlt_.analyzePattern(laplacian.W);
    for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
        shift_ = sigma * (1.0 + attempt * kNudge);
        shifted_ = laplacian.W;
        shifted_.diagonal() -= shift_ * laplacian.D;
        ldlt_.factorize(shifted_);
        if (ldlt_.info() != Eigen::Success) continue;
        pivots_ = ldlt_.vectorD();
        if (!pivots_.allFinite()) continue;
        below_ = (pivots_.array() < 0.0).count();
        return;
    }
    throw SolverFailure("the LDL^T factorization of W - sigma D meets a zero pivot at sigma = " +
                        std::to_string(sigma));
}

Eigen::MatrixXd ShiftedLdlt::solve(const Eigen::MatrixXd& B) const {
    Eigen::MatrixXd X(B.rows(), B.cols());
    // The factor is far larger than the cache: each pass over it serves as many columns as it can.
    Index c = 0;
    for (; c + 8 <= B.cols(); c += 8) solveColumns<8>(B, c, X);
    for (; c + 4 <= B.cols(); c += 4) solveColumns<4>(B, c, X);
    switch (B.cols() - c) {
        case 3: solveColumns<3>(B, c, X); break;
        case 2: solveColumns<2>(B, c, X); break;
        case 1: solveColumns<1>(B, c, X); break;
        default: break;
    }
    return X;
}

template <int Columns>
void ShiftedLdlt::solveColumns(const Eigen::MatrixXd& B, Index first, Eigen::MatrixXd& X) const {
    const UnitLower L(ldlt_.matrixL().nestedExpression());
    const Eigen::VectorXi& order = ldlt_.permutationP().indices();
    const Index n = B.rows();
    constexpr int kMost = Columns < 4 ? 4 : 2;  // as many as fit into the registers

    Block<Columns> Y(n, Columns);
    for (Index i = 0; i < n; ++i) Y.row(order[i]) = B.row(i).segment<Columns>(first).array();
    for (Index j = 0; j < n;) {  // L Y = P B
        const int width = L.width(j, kMost);
        switch (width) {
            case 4: L.eliminate<4>(j, Y); break;
            case 3: L.eliminate<3>(j, Y); break;
            case 2: L.eliminate<2>(j, Y); break;
            default: L.eliminate<1>(j, Y); break;
        }
        j += width;
    }
    Y.colwise() /= pivots_.array();
    for (Index end = n; end > 0;) {  // L^T Z = D^-1 Y
        const int width = L.widthBefore(end, kMost);
        switch (width) {
            case 4: L.substitute<4>(end - 4, Y); break;
            case 3: L.substitute<3>(end - 3, Y); break;
            case 2: L.substitute<2>(end - 2, Y); break;
            default: L.substitute<1>(end - 1, Y); break;
        }
        end -= width;
    }
    for (Index i = 0; i < n; ++i) X.row(i).segment<Columns>(first) = Y.row(order[i]).matrix();
}

}  // namespace spectral
