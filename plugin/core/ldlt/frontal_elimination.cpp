// Compiled once for each instruction set: see README.md.
#include <Eigen/Core>
#include <algorithm>

#include "core/ldlt/kernels.h"
#include "core/ldlt/subnormals.h"

namespace spectral {

namespace {

using Size = std::ptrdiff_t;
using Lane = Eigen::Array<double, kLane, 1>;
using Matrix = Eigen::Map<Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;

/// Columns and inner dimensions from which Eigen's product is faster than the loops here; it then
/// gets blocks of this many columns.
constexpr Size kManyColumns = 32, kManyInner = 8;

/// Eigen computes a product coefficient by coefficient if its three sizes sum to less than this.
constexpr Size kSmallProduct = 20;

/// Multiplications from which it pays to use several threads.
constexpr Size kMuchWork = 500000;

auto lane(double* at) { return Eigen::Map<Lane>(at); }
auto lane(const double* at) { return Eigen::Map<const Lane>(at); }

/// i rounded down to a multiple of kLane.
Size aligned(Size i) { return i / kLane * kLane; }

/// C -= L (L diag(pivots))^T, lower triangle only. L holds the eliminated columns of a frontal
/// matrix, Lpivots the same columns times the pivots; their first row is that of C's first column.
struct Subtraction {
    const double *L = nullptr, *Lpivots = nullptr;
    Size stride = 0;  // column stride of L and Lpivots
    Size inner = 0;   // number of columns of L and Lpivots
    double* C = nullptr;
    Size strideC = 0, columns = 0;
    Size rows = 0;  // a multiple of kLane
};

template <int Inner, int Columns>
void subtractFew(const Subtraction& s, Size inner, Size column, Size row) {
    double factor[Inner][Columns];
    for (int a = 0; a < Inner; ++a)
        for (int j = 0; j < Columns; ++j)
            factor[a][j] = s.Lpivots[(inner + a) * s.stride + column + j];
    const double* L = s.L + inner * s.stride;
    double* C = s.C + column * s.strideC;
    for (; row < s.rows; row += kLane) {
        Lane l[Inner];
        for (int a = 0; a < Inner; ++a) l[a] = lane(L + a * s.stride + row);
        for (int j = 0; j < Columns; ++j) {
            Lane c = lane(C + j * s.strideC + row);
            for (int a = 0; a < Inner; ++a) c -= factor[a][j] * l[a];
            lane(C + j * s.strideC + row) = c;
        }
    }
}

template <int Inner>
void subtractInner(const Subtraction& s, Size inner) {
    constexpr int kColumns = kLane;
    Size j = 0;
    for (; j + kColumns <= s.columns; j += kColumns) subtractFew<Inner, kColumns>(s, inner, j, j);
    for (Size i = j; i < s.columns; ++i) subtractFew<Inner, 1>(s, inner, i, j);
}

void subtractByLoops(const Subtraction& s) {
    Size a = 0;
    for (; a + 4 <= s.inner; a += 4) subtractInner<4>(s, a);
    switch (s.inner - a) {
        case 3: subtractInner<3>(s, a); break;
        case 2: subtractInner<2>(s, a); break;
        case 1: subtractInner<1>(s, a); break;
        default: break;
    }
}

/// Updates up to kManyColumns columns from j on by Eigen's product.
void subtractProduct(const Subtraction& s, Size j) {
    const Size columns = std::min(kManyColumns, s.columns - j), rows = s.rows - j;
    const double *L = s.L + j, *Lpivots = s.Lpivots + j;
    double* C = s.C + j * s.strideC + j;
    // Eigen's rounding of small products depends on the alignment of their address.
    if (rows + columns + s.inner < kSmallProduct)
        return subtractByLoops({L, Lpivots, s.stride, s.inner, C, s.strideC, columns, rows});
    const Eigen::OuterStride<> stride(s.stride), strideC(s.strideC);
    Matrix(C, rows, columns, strideC).noalias() -=
        ConstMatrix(L, rows, s.inner, stride) *
        ConstMatrix(Lpivots, columns, s.inner, stride).transpose();
}

void subtract(const Subtraction& s, const FrontalMatrix& front) {
    if (s.inner < kManyInner || s.columns < kManyColumns) return subtractByLoops(s);
    const Size blocks = (s.columns + kManyColumns - 1) / kManyColumns;
    const auto one = [](const void* subtraction, Size block) {
        const SubnormalsAreZero mode;  // set per thread
        subtractProduct(*static_cast<const Subtraction*>(subtraction), block * kManyColumns);
    };
    if (front.parallelFor != nullptr && s.inner * s.columns * s.rows >= kMuchWork)
        return front.parallelFor(blocks, one, &s);
    for (Size block = 0; block < blocks; ++block) one(&s, block);
}

/// Eliminates the pivot columns of a frontal matrix.
class PivotColumns {
  public:
    explicit PivotColumns(const FrontalMatrix& front) : front_(front) {}

    /// Eliminates columns begin to end - 1, already updated by all columns before. False when a
    /// pivot is 0.
    bool eliminate(Size begin, Size end) const {
        if (end - begin <= kLane) return eliminateFew(begin, end);
        // Eliminate one half, then update the other half, whose rows start at a multiple of kLane.
        Size middle = aligned(front_.offset + (begin + end) / 2) - front_.offset;
        if (middle <= begin) middle += kLane;
        if (!eliminate(begin, middle)) return false;
        const Size from = begin * front_.stride + front_.offset + middle;
        double* C = front_.columns + middle * front_.stride + front_.offset + middle;
        subtract({front_.columns + from, front_.scratch + from, front_.stride, middle - begin, C,
                  front_.stride, end - middle, front_.stride - front_.offset - middle},
                 front_);
        return eliminate(middle, end);
    }

    /// Updates the contribution block by the eliminated columns.
    void updateContribution() const {
        const Size from = front_.offset + front_.width, rows = front_.stride - from;
        subtract({front_.columns + from, front_.scratch + from, front_.stride, front_.width,
                  front_.contribution, rows, front_.below, rows},
                 front_);
    }

  private:
    bool eliminateFew(Size begin, Size end) const {
        for (Size a = begin; a < end; ++a) {
            const Size diagonal = front_.offset + a;
            double* column = front_.columns + a * front_.stride;
            double* Lpivot = front_.scratch + a * front_.stride;
            for (Size b = begin; b < a; ++b) {
                const double factor = front_.scratch[b * front_.stride + diagonal];
                const double* L = front_.columns + b * front_.stride;
                for (Size i = aligned(diagonal); i < front_.stride; i += kLane)
                    lane(column + i) -= factor * lane(L + i);
            }
            const double pivot = column[diagonal];
            if (pivot == 0.0) return false;
            const double inverse = 1.0 / pivot;
            for (Size i = aligned(diagonal); i < front_.stride; i += kLane) {
                const Lane l = lane(column + i);
                lane(Lpivot + i) = l;
                lane(column + i) = inverse * l;
            }
            column[diagonal] = pivot;
        }
        return true;
    }

    const FrontalMatrix& front_;
};

}  // namespace

namespace SPECTRAL_INSTRUCTIONS {

bool eliminateFront(const FrontalMatrix& front) {
    const SubnormalsAreZero mode;
    const PivotColumns columns(front);
    dropTiny(front.columns, front.width * front.stride);
    if (!columns.eliminate(0, front.width)) return false;
    dropTiny(front.columns, front.width * front.stride);
    columns.updateContribution();
    dropTiny(front.contribution, front.below * front.contributionStride());
    return true;
}

}  // namespace SPECTRAL_INSTRUCTIONS

}  // namespace spectral
