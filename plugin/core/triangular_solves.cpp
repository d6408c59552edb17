// Compiled once for each instruction set, as dense_products.cpp is: see there.
#include "triangular_solves.h"

#include <Eigen/Core>
#include <algorithm>

namespace spectral {

namespace {

using Size = std::ptrdiff_t;

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
    explicit UnitLower(const LdltFactor& factor)
        : start_(factor.starts),
          rowStart_(factor.rowStarts),
          row_(factor.rows),
          value_(factor.values),
          joined_(factor.joined) {}

    /// Number of columns from j on, at most so many, that have the same rows below them.
    int width(Size j, int most) const {
        int width = 1;
        while (width < most && joined_[j + width - 1]) ++width;
        return width;
    }

    /// The same for the columns that end before `end`.
    int widthBefore(Size end, int most) const {
        int width = 1;
        while (width < most && end > width && joined_[end - width - 1]) ++width;
        return width;
    }

    /// Forward elimination by columns j to j + Width - 1.
    template <int Width, int Columns>
    void eliminate(Size j, Block<Columns>& Y) const {
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
    void substitute(Size j, Block<Columns>& Y) const {
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
        Tails(const UnitLower& L, Size j)
            : size(L.count(j + Width - 1)), row(L.row_ + L.rowStart_[j + Width - 1]) {
            for (int k = 0; k < Width; ++k) value[k] = L.value_ + L.start_[j + k] + Width - 1 - k;
        }
        int size;
        const int* row;
        const double* value[Width];
    };

    int count(Size j) const { return start_[j + 1] - start_[j]; }

    const int* start_;
    const int* rowStart_;
    const int* row_;
    const double* value_;
    const char* joined_;
};

/// @param used  of the columns that are taken at once, those that there are.
template <int Columns>
void applyToColumns(const LdltFactor& factor, const double* d, double root, double* columns,
                    int used = Columns) {
    const UnitLower L(factor);
    const Size n = factor.n;
    Eigen::Map<Eigen::Array<double, Eigen::Dynamic, Columns>> X(columns, n, Columns);
    constexpr int kMost = 4;  // columns of L at once: as many as fit into the registers

    Block<Columns> Y(n, Columns);
    if (used == Columns) {
        for (Size i = 0; i < n; ++i) Y.row(factor.order[i]) = d[i] * X.row(i);
    } else {
        Y.setZero();
        for (Size i = 0; i < n; ++i)
            for (int c = 0; c < used; ++c) Y(factor.order[i], c) = d[i] * X(i, c);
    }
    for (Size j = 0; j < n;) {  // L Y = P diag(d) X
        const int width = L.width(j, kMost);
        switch (width) {
            case 4: L.eliminate<4>(j, Y); break;
            case 3: L.eliminate<3>(j, Y); break;
            case 2: L.eliminate<2>(j, Y); break;
            default: L.eliminate<1>(j, Y); break;
        }
        j += width;
    }
    Y.colwise() /= Eigen::Map<const Eigen::ArrayXd>(factor.pivots, n);
    for (Size end = n; end > 0;) {  // L^T Z = D^-1 Y
        const int width = L.widthBefore(end, kMost);
        switch (width) {
            case 4: L.substitute<4>(end - 4, Y); break;
            case 3: L.substitute<3>(end - 3, Y); break;
            case 2: L.substitute<2>(end - 2, Y); break;
            default: L.substitute<1>(end - 1, Y); break;
        }
        end -= width;
    }
    if (used == Columns) {
        for (Size i = 0; i < n; ++i) X.row(i) = Y.row(factor.order[i]) - root * X.row(i);
    } else {
        for (Size i = 0; i < n; ++i)
            for (int c = 0; c < used; ++c) X(i, c) = Y(factor.order[i], c) - root * X(i, c);
    }
}

void apply(const LdltFactor& factor, const double* d, double root, double* X, Size columns) {
    // The factor is far larger than the cache: each pass over it serves as many columns as it can,
    // those that fit into the registers. A few more than there are cost less than one pass more.
    constexpr int kMost = EIGEN_MAX_STATIC_ALIGN_BYTES >= 4 * sizeof(double) ? 16 : 8;
    for (Size c = 0; c < columns; c += kMost) {
        double* first = X + c * factor.n;
        const auto used = static_cast<int>(std::min<Size>(kMost, columns - c));
        switch (used) {
            case 1: applyToColumns<1>(factor, d, root, first); break;
            case 2: applyToColumns<2>(factor, d, root, first); break;
            case 3: applyToColumns<3>(factor, d, root, first); break;
            case 4: applyToColumns<4>(factor, d, root, first); break;
            case 5:
            case 6:
            case 7:
            case 8: applyToColumns<8>(factor, d, root, first, used); break;
            default: applyToColumns<kMost>(factor, d, root, first, used); break;
        }
    }
}

}  // namespace

namespace SPECTRAL_INSTRUCTIONS {
extern const TriangularSolves triangularSolves;
const TriangularSolves triangularSolves{apply};
}  // namespace SPECTRAL_INSTRUCTIONS

}  // namespace spectral
