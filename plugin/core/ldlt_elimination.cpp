#include "ldlt_elimination.h"

#include <algorithm>
#include <cstddef>

namespace spectral {

namespace {

/// Columns of L at a time: as many as keep their numbers in registers.
constexpr int kMostColumns = 4;

/// y -= sum_a values[a] x[a] at the common rows of Width columns of L.
template <int Width>
void subtractColumns(const int* rows, int count, const double* const* values, const double* x,
                     double* y) {
    double factor[Width];  // copies: the compiler cannot know that y is something else
    const double* column[Width];
    std::copy_n(x, Width, factor);
    std::copy_n(values, Width, column);
    for (int p = 0; p < count; ++p) {
        double sum = column[0][p] * factor[0];
        for (int a = 1; a < Width; ++a) sum += column[a][p] * factor[a];
        y[rows[p]] -= sum;
    }
}

/// Row k of L solves a triangular system with the rows above: L y = column k of the matrix, and
/// then l_k = y / pivots. Its entries are where paths in the elimination tree lead from those of
/// that column.
class Elimination {
  public:
    Elimination(const SymbolicLdlt& symbolic, const Laplacian& laplacian, double sigma,
                LdltNumbers& numbers)
        : symbolic_(symbolic),
          W_(laplacian.W.valuePtr()),
          shifts_(laplacian.D.size()),
          numbers_(numbers),
          y_(Eigen::VectorXd::Zero(laplacian.D.size())),
          pattern_(static_cast<std::size_t>(laplacian.D.size())),
          visited_(pattern_.size(), -1),
          ends_(symbolic.factorStarts.begin(), symbolic.factorStarts.end() - 1) {
        for (Index i = 0; i < shifts_.size(); ++i)
            shifts_[symbolic.order[i]] = sigma * laplacian.D[i];
        numbers_.rows.resize(static_cast<std::size_t>(symbolic.factorStarts.back()));
        numbers_.values.resize(numbers_.rows.size());
        numbers_.pivots.resize(shifts_.size());
    }

    bool run() {
        const auto n = static_cast<int>(shifts_.size());
        for (int k = 0; k < n; ++k) {
            int next = gather(k);
            double pivot = y_[k] - shifts_[k];
            y_[k] = 0.0;
            while (next < n) next += eliminateColumns(k, next, pivot);
            if (pivot == 0.0) return false;
            numbers_.pivots[k] = pivot;
        }
        return true;
    }

  private:
    /// Puts column k of the upper half into y, and the columns of row k of L into the pattern,
    /// each before those that depend on it. Returns where the pattern begins; it ends at n.
    int gather(int k) {
        auto begin = static_cast<int>(pattern_.size());
        visited_[k] = k;
        for (int p = symbolic_.upperStarts[k]; p < symbolic_.upperStarts[k + 1]; ++p) {
            int i = symbolic_.upperRows[p], length = 0;
            y_[i] += W_[symbolic_.upperSources[p]];
            for (; visited_[i] != k; i = symbolic_.parent[i]) {
                pattern_[length++] = i;
                visited_[i] = k;
            }
            while (length > 0) pattern_[--begin] = pattern_[--length];
        }
        return begin;
    }

    /// The next columns of row k, as many of one supernode as go at once: makes their entries, and
    /// takes what they contribute from the rest of y and from the pivot. Returns their number.
    int eliminateColumns(int k, int next, double& pivot) {
        const int first = pattern_[next], width = widthOf(next), last = first + width - 1;
        double x[kMostColumns];
        const double* values[kMostColumns];
        for (int a = 0; a < width; ++a) {
            x[a] = y_[first + a];
            for (int b = 0; b < a; ++b) x[a] -= column(first + b)[a - b - 1] * x[b];
            y_[first + a] = 0.0;
            values[a] = column(first + a) + (width - 1 - a);  // from the first common row on
        }
        const int begin = symbolic_.factorStarts[last], count = ends_[last] - begin;
        const int* rows = numbers_.rows.data() + begin;
        switch (width) {
            case 4: subtractColumns<4>(rows, count, values, x, y_.data()); break;
            case 3: subtractColumns<3>(rows, count, values, x, y_.data()); break;
            case 2: subtractColumns<2>(rows, count, values, x, y_.data()); break;
            default: subtractColumns<1>(rows, count, values, x, y_.data()); break;
        }
        for (int a = 0; a < width; ++a) {
            const double l = x[a] / numbers_.pivots[first + a];
            pivot -= l * x[a];
            const int end = ends_[first + a]++;
            numbers_.rows[end] = k;
            numbers_.values[end] = l;
        }
        return width;
    }

    int widthOf(int next) const {
        const int first = pattern_[next], end = static_cast<int>(pattern_.size());
        int width = 1;
        while (width < kMostColumns && next + width < end && symbolic_.joined[first + width - 1] &&
               pattern_[next + width] == first + width)
            ++width;
        return width;
    }

    const double* column(int j) const { return numbers_.values.data() + symbolic_.factorStarts[j]; }

    const SymbolicLdlt& symbolic_;
    const double* W_;
    Eigen::VectorXd shifts_;  // sigma D, in the order of the factor
    LdltNumbers& numbers_;
    Eigen::VectorXd y_;  // zero between rows
    std::vector<int> pattern_, visited_;
    std::vector<int> ends_;  // of the columns of L so far
};

}  // namespace

bool eliminate(const SymbolicLdlt& symbolic, const Laplacian& laplacian, double sigma,
               LdltNumbers& numbers) {
    return Elimination(symbolic, laplacian, sigma, numbers).run();
}

}  // namespace spectral
