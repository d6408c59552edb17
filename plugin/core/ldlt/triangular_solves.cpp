// Compiled once for each instruction set: see README.md.
#include <Eigen/Core>

#include "core/ldlt/kernels.h"
#include "core/ldlt/subnormals.h"

namespace spectral {

namespace {

using Size = std::ptrdiff_t;

/// One row of the right-hand sides.
template <int Columns>
using Row = Eigen::Array<double, 1, Columns>;

/// A few right-hand sides, row-major.
template <int Columns>
class Block {
  public:
    explicit Block(double* Y) : Y_(Y) {}
    Eigen::Map<Row<Columns>> row(Size i) { return Eigen::Map<Row<Columns>>(Y_ + i * Columns); }

  private:
    double* Y_;
};

/// A sparse unit lower triangular matrix; the diagonal is not stored.
///
/// Most entries are in supernodes, consecutive columns with the same rows below them. Several of
/// these columns are processed at once: each row of the right-hand sides is then loaded only once.
class UnitLower {
  public:
    explicit UnitLower(const LdltFactor& factor)
        : start_(factor.starts),
          rowStart_(factor.rowStarts),
          row_(factor.rows),
          value_(factor.values),
          joined_(factor.joined) {}

    /// Number of columns from j on, up to `limit`, that have the same rows below them.
    int width(Size j, int limit) const {
        int width = 1;
        while (width < limit && joined_[j + width - 1]) ++width;
        return width;
    }

    /// The same for the columns up to `end` - 1.
    int widthBefore(Size end, int limit) const {
        int width = 1;
        while (width < limit && end > width && joined_[end - width - 1]) ++width;
        return width;
    }

    /// Forward elimination with columns j to j + Width - 1.
    template <int Width, int Columns>
    void eliminate(Size j, Block<Columns> Y) const {
        Row<Columns> y[Width];
        for (int i = 0; i < Width; ++i) {
            y[i] = Y.row(j + i);
            for (int k = 0; k < i; ++k) y[i] -= value_[start_[j + k] + i - k - 1] * y[k];
            dropTiny(y[i].data(), Columns);
            Y.row(j + i) = y[i];
        }
        const Tails<Width> tails(*this, j);
        for (int p = 0; p < tails.size; ++p) {
            Row<Columns> z = Y.row(tails.row[p]);
            for (int k = 0; k < Width; ++k) z -= tails.value[k][p] * y[k];
            Y.row(tails.row[p]) = z;
        }
    }

    /// Back substitution with the transposes of columns j to j + Width - 1.
    template <int Width, int Columns>
    void substitute(Size j, Block<Columns> Y) const {
        Row<Columns> y[Width];
        for (int i = 0; i < Width; ++i) y[i] = Y.row(j + i);
        const Tails<Width> tails(*this, j);
        for (int p = 0; p < tails.size; ++p) {
            const Row<Columns> z = Y.row(tails.row[p]);
            for (int k = 0; k < Width; ++k) y[k] -= tails.value[k][p] * z;
        }
        for (int i = Width - 1; i >= 0; --i) {
            dropTiny(y[i].data(), Columns);
            for (int k = 0; k < i; ++k) y[k] -= value_[start_[j + k] + i - k - 1] * y[i];
            Y.row(j + i) = y[i];
        }
    }

  private:
    /// The rows below a group of columns, and the entries in these rows.
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

/// Columns of L processed at once: as many as fit into the registers.
constexpr int kMaxColumns = 4;

template <int Columns>
void forwardColumns(const LdltFactor& factor, double* rows, Size begin, Size end) {
    const UnitLower L(factor);
    const Block<Columns> Y(rows);
    for (Size j = begin; j < end;) {
        const int width = L.width(j, kMaxColumns);
        switch (width) {
            case 4: L.eliminate<4>(j, Y); break;
            case 3: L.eliminate<3>(j, Y); break;
            case 2: L.eliminate<2>(j, Y); break;
            default: L.eliminate<1>(j, Y); break;
        }
        j += width;
    }
}

template <int Columns>
void backwardColumns(const LdltFactor& factor, double* rows, Size begin, Size end) {
    const UnitLower L(factor);
    const Block<Columns> Y(rows);
    while (end > begin) {
        const int width = L.widthBefore(end, kMaxColumns);
        switch (width) {
            case 4: L.substitute<4>(end - 4, Y); break;
            case 3: L.substitute<3>(end - 3, Y); break;
            case 2: L.substitute<2>(end - 2, Y); break;
            default: L.substitute<1>(end - 1, Y); break;
        }
        end -= width;
    }
}

}  // namespace

namespace SPECTRAL_INSTRUCTIONS {

void forward(const LdltFactor& factor, double* Y, int columns, Size begin, Size end) {
    const SubnormalsAreZero mode;
    switch (columns) {
        case 1: return forwardColumns<1>(factor, Y, begin, end);
        case 2: return forwardColumns<2>(factor, Y, begin, end);
        case 3: return forwardColumns<3>(factor, Y, begin, end);
        case 4: return forwardColumns<4>(factor, Y, begin, end);
        default: return forwardColumns<kMaxRightHandSides>(factor, Y, begin, end);
    }
}

void backward(const LdltFactor& factor, double* Y, int columns, Size begin, Size end) {
    const SubnormalsAreZero mode;
    switch (columns) {
        case 1: return backwardColumns<1>(factor, Y, begin, end);
        case 2: return backwardColumns<2>(factor, Y, begin, end);
        case 3: return backwardColumns<3>(factor, Y, begin, end);
        case 4: return backwardColumns<4>(factor, Y, begin, end);
        default: return backwardColumns<kMaxRightHandSides>(factor, Y, begin, end);
    }
}

}  // namespace SPECTRAL_INSTRUCTIONS

}  // namespace spectral
