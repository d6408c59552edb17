#include "core/krylov/krylov_spaces.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/krylov/tridiagonal.h"
#include "core/laplacian/constant_modes.h"
#include "core/laplacian/frequency.h"
#include "core/support/thread_team.h"

namespace spectral {

namespace {

/// Norm below which a new direction is round-off: the space is invariant, the result exact.
constexpr double kBreakdown = 1e-13;

/// Inner products of basis vectors up to which the basis counts as orthogonal, and what round-off
/// makes of one that is 0.
constexpr double kOrthogonal = 1e-10, kRoundOff = 1e-15;

/// The numbers of a row, one for each signal.
template <int Columns>
using Row = Eigen::Array<double, 1, Columns, Eigen::RowMajor | Eigen::DontAlign>;

template <int Columns>
Eigen::Map<Row<Columns>> rowOf(Eigen::VectorXd& block, Index i) {
    return Eigen::Map<Row<Columns>>(block.data() + i * Columns);
}
template <int Columns>
Eigen::Map<const Row<Columns>> rowOf(const Eigen::VectorXd& block, Index i) {
    return Eigen::Map<const Row<Columns>>(block.data() + i * Columns);
}

template <int Columns>
Row<Columns> lastOf(const std::vector<std::vector<double>>& ofColumns) {
    Row<Columns> last = Row<Columns>::Zero();
    for (int c = 0; c < Columns; ++c)
        if (!ofColumns[c].empty()) last[c] = ofColumns[c].back();
    return last;
}

/// What a task has summed, over the rows of one component after the other.
template <int Columns>
struct ComponentSum {
    int label;
    Row<Columns> sum;
};

/// D-weighted means on every component, count x Columns, and sums of squares without them.
template <int Columns>
struct Moments {
    Eigen::Array<double, Eigen::Dynamic, Columns> means;
    Row<Columns> squares;
};

/// Those of the rows that `row` makes and returns. The means are to be small: their squares are
/// subtracted.
template <int Columns, class MakeRow>
Moments<Columns> momentsOf(const Eigen::VectorXd& D, const Eigen::VectorXi& label,
                           const Eigen::VectorXd& mass, const MakeRow& row) {
    std::vector<std::vector<ComponentSum<Columns>>> parts(
        static_cast<std::size_t>((D.size() + kRowsOfTask - 1) / kRowsOfTask));
    Moments<Columns> moments;
    moments.squares =
        parallelSum(D.size(), Row<Columns>::Zero().eval(), [&](Index begin, Index end) {
            std::vector<ComponentSum<Columns>>& sums = parts[begin / kRowsOfTask];
            Row<Columns> squares = Row<Columns>::Zero();
            for (Index i = begin; i < end;) {
                ComponentSum<Columns> component{label[i], Row<Columns>::Zero()};
                for (; i < end && label[i] == component.label; ++i) {
                    const Row<Columns> x = row(i), Dx = D[i] * x;
                    component.sum += Dx;
                    squares += Dx * x;
                }
                if (component.label >= 0) sums.push_back(component);
            }
            return squares;
        });
    moments.means = Eigen::Array<double, Eigen::Dynamic, Columns>::Zero(mass.size(), Columns);
    for (const auto& sums : parts)
        for (const ComponentSum<Columns>& component : sums)
            moments.means.row(component.label) += component.sum;
    moments.means.colwise() /= mass.array();
    moments.squares -= (moments.means.square().colwise() * mass.array()).colwise().sum();
    moments.squares = moments.squares.max(0.0);
    return moments;
}

}  // namespace

KrylovSpaces::KrylovSpaces(const ShiftedCholesky& cholesky, const Eigen::VectorXd& D,
                           const ConstantModes& constants, const Eigen::MatrixXd& X)
    : cholesky_(cholesky),
      constants_(constants),
      columns_(static_cast<int>(X.cols())),
      D_(D.size()),
      label_(D.size()),
      alpha_(X.cols()),
      beta_(X.cols()),
      overlap_(X.cols()),
      overlapBefore_(X.cols()),
      exhausted_(X.cols()) {
    assert(columns_ >= 1 && columns_ <= kMostSignals);
    const Eigen::VectorXi& order = cholesky.factorOrder();
    parallelRows(D.size(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            D_[order[i]] = D[i];
            label_[order[i]] = constants.label()[i];
        }
    });
    switch (columns_) {
        case 1: start<1>(X); break;
        case 2: start<2>(X); break;
        case 3: start<3>(X); break;
        default: start<4>(X); break;
    }
}

bool KrylovSpaces::extend() {
    if (std::find(exhausted_.begin(), exhausted_.end(), false) == exhausted_.end()) return false;
    switch (columns_) {
        case 1: extendColumns<1>(); break;
        case 2: extendColumns<2>(); break;
        case 3: extendColumns<3>(); break;
        default: extendColumns<4>(); break;
    }
    return true;
}

template <int Columns>
void KrylovSpaces::start(const Eigen::MatrixXd& X) {
    const Index n = D_.size();
    work_.resize(cholesky_.orderedRows() * Columns);
    const Eigen::VectorXi& order = cholesky_.factorOrder();
    parallelRows(n, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) rowOf<Columns>(work_, order[i]) = X.row(i).array();
    });
    const auto mean = momentsOf<Columns>(D_, label_, constants_.masses(), [&](Index i) {
                          return Row<Columns>(rowOf<Columns>(work_, i));
                      }).means;
    std::vector<double> largest(static_cast<std::size_t>((n + kRowsOfTask - 1) / kRowsOfTask));
    const Row<Columns> squares =
        parallelSum(n, Row<Columns>::Zero().eval(), [&](Index begin, Index end) {
            Row<Columns> sum = Row<Columns>::Zero();
            for (Index i = begin; i < end; ++i) {
                auto x = rowOf<Columns>(work_, i);
                if (label_[i] >= 0) x -= mean.row(label_[i]);
                sum += D_[i] * x * x;
                largest[begin / kRowsOfTask] =
                    std::max(largest[begin / kRowsOfTask], x.abs().maxCoeff());
            }
            return sum;
        });
    norms_ = squares.sqrt().transpose();
    for (const double entry : largest) largestEntry_ = std::max(largestEntry_, entry);
    Row<Columns> inverse = Row<Columns>::Zero();
    for (int c = 0; c < Columns; ++c) {
        exhausted_[c] = !(norms_[c] > 0.0);
        if (!exhausted_[c]) inverse[c] = 1.0 / norms_[c];
    }
    basis_.emplace_back(n * Columns);
    parallelRows(n, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const Row<Columns> q = inverse * rowOf<Columns>(work_, i);
            rowOf<Columns>(basis_.back(), i) = q;
            rowOf<Columns>(work_, i) = D_[i] * q;
        }
    });
}

template <int Columns>
void KrylovSpaces::extendColumns() {
    const Index n = D_.size();
    cholesky_.solveOrdered(work_.data(), Columns);
    const Block& q = basis_.back();
    const Row<Columns> alpha =
        parallelSum(n, Row<Columns>::Zero().eval(), [&](Index begin, Index end) {
            Row<Columns> sum = Row<Columns>::Zero();
            for (Index i = begin; i < end; ++i)
                sum += D_[i] * rowOf<Columns>(q, i) * rowOf<Columns>(work_, i);
            return sum;
        });

    // w = S q - alpha q - beta p, with the vector p before q. That keeps the complement of the
    // constants; round-off does not, and would grow from step to step.
    const Row<Columns> before = lastOf<Columns>(beta_);
    const Block& p = basis_[basis_.size() > 1 ? basis_.size() - 2 : 0];
    const Moments<Columns> w = momentsOf<Columns>(D_, label_, constants_.masses(), [&](Index i) {
        auto row = rowOf<Columns>(work_, i);
        row -= alpha * rowOf<Columns>(q, i) + before * rowOf<Columns>(p, i);
        return Row<Columns>(row);
    });
    Row<Columns> beta = w.squares.sqrt();
    for (int c = 0; c < Columns; ++c)
        if (!exhausted_[c]) alpha_[c].push_back(alpha[c]);
    if (losesOrthogonality(beta)) beta = orthogonalize<Columns>(beta);

    Row<Columns> inverse = Row<Columns>::Zero();
    for (int c = 0; c < Columns; ++c) {
        if (exhausted_[c]) continue;
        const double scale = std::hypot(alpha[c], before[c]);
        exhausted_[c] =
            !(beta[c] > kBreakdown * scale) || static_cast<Index>(alpha_[c].size()) == n;
        if (exhausted_[c]) continue;
        beta_[c].push_back(beta[c]);
        inverse[c] = 1.0 / beta[c];
    }

    Block next(n * Columns);
    parallelRows(n, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            Row<Columns> row = rowOf<Columns>(work_, i);
            if (label_[i] >= 0) row -= w.means.row(label_[i]);
            row *= inverse;
            rowOf<Columns>(next, i) = row;
            rowOf<Columns>(work_, i) = D_[i] * row;
        }
    });
    basis_.push_back(std::move(next));
}

/// Follows the inner products of the vector to come with all before, by the recurrence that they
/// obey themselves (Simon 1984), and says whether they have become too large. As round-off grows in
/// the vector after the next one, too, that is then orthogonalized as well.
bool KrylovSpaces::losesOrthogonality(const Eigen::Ref<const Eigen::ArrayXd>& beta) {
    bool loses = false;
    for (int c = 0; c < columns_; ++c) {
        if (exhausted_[c]) continue;
        const std::vector<double>&alpha = alpha_[c], &betas = beta_[c];
        const std::size_t j = alpha.size() - 1;
        std::vector<double>&now = overlap_[c], next(j + 2), &past = overlapBefore_[c];
        now.resize(j + 1, 1.0);
        for (std::size_t k = 0; k < j; ++k) {
            double sum = betas[k] * now[k + 1] + (alpha[k] - alpha[j]) * now[k];
            if (k > 0) sum += betas[k - 1] * now[k - 1];
            sum = (sum - betas[j - 1] * past[k]) / beta[c];
            next[k] = sum + std::copysign(kRoundOff, sum);
            loses = loses || !(std::abs(next[k]) <= kOrthogonal);
        }
        next[j] = kRoundOff;
        next[j + 1] = 1.0;
        loses = loses || !(beta[c] > std::sqrt(kBreakdown) * std::abs(alpha[j]));
        past = std::move(now);
        now = std::move(next);
    }
    return std::exchange(orthogonalizesNext_, loses) || loses;
}

/// Subtracts from the vectors in `work_` what they have of the basis; returns their norms.
template <int Columns>
Eigen::Array<double, 1, Columns> KrylovSpaces::orthogonalize(
    Eigen::Array<double, 1, Columns> norm) {
    using Overlaps = Eigen::Array<double, Eigen::Dynamic, Columns>;
    const Index n = D_.size(), m = static_cast<Index>(basis_.size());
    for (int pass = 0; pass < 2; ++pass) {
        const Overlaps overlaps =
            parallelSum(n, Overlaps(Overlaps::Zero(m, Columns)), [&](Index begin, Index end) {
                Overlaps sums = Overlaps::Zero(m, Columns);
                for (Index j = 0; j < m; ++j) {
                    Row<Columns> sum = Row<Columns>::Zero();
                    for (Index i = begin; i < end; ++i)
                        sum += D_[i] * rowOf<Columns>(basis_[j], i) * rowOf<Columns>(work_, i);
                    sums.row(j) = sum;
                }
                return sums;
            });
        const Row<Columns> squares =
            parallelSum(n, Row<Columns>::Zero().eval(), [&](Index begin, Index end) {
                for (Index j = 0; j < m; ++j) {
                    const Row<Columns> overlap = overlaps.row(j);
                    for (Index i = begin; i < end; ++i)
                        rowOf<Columns>(work_, i) -= overlap * rowOf<Columns>(basis_[j], i);
                }
                Row<Columns> sum = Row<Columns>::Zero();
                for (Index i = begin; i < end; ++i)
                    sum += D_[i] * rowOf<Columns>(work_, i).square();
                return sum;
            });
        const Row<Columns> before = std::exchange(norm, squares.sqrt());
        if ((norm >= 0.5 * before).all()) break;  // else round-off has left something of it
    }
    for (std::vector<double>& overlaps : overlap_)
        if (!overlaps.empty()) std::fill(overlaps.begin(), overlaps.end() - 1, kRoundOff);
    return norm;
}

KrylovSpaces::Ritz KrylovSpaces::ritz(int column) const {
    const auto m = static_cast<Index>(alpha_[column].size());
    if (m == 0) return {};
    std::vector<double> beta = beta_[column];
    beta.resize(static_cast<std::size_t>(m - 1));  // the last one leads out of the space
    TridiagonalEigenpairs T = eigenpairsOfTridiagonal(alpha_[column], beta);
    Ritz pairs{Eigen::VectorXd(m), std::move(T.vectors)};
    for (Index i = 0; i < m; ++i) {
        // theta = 1/(lambda + pole); round-off may push it out of (0, 1/pole].
        const double theta = T.values[i];
        const double lambda = theta > 0.0 ? std::max(0.0, 1.0 / theta - cholesky_.shift())
                                          : std::numeric_limits<double>::infinity();
        pairs.omega[i] = std::sqrt(lambda);
    }
    return pairs;
}

Eigen::VectorXd KrylovSpaces::coefficients(int column, const Gain& gain) const {
    const Ritz pairs = ritz(column);
    if (pairs.omega.size() == 0) return {};
    Eigen::VectorXd gains(pairs.omega.size());
    for (Index i = 0; i < gains.size(); ++i) gains[i] = gain(pairs.omega[i]);
    return norms_[column] * (pairs.Q * gains.cwiseProduct(pairs.Q.row(0).transpose()));
}

Quadrature KrylovSpaces::quadrature(int column) const {
    Ritz pairs = ritz(column);
    if (pairs.omega.size() == 0) return {};
    const double norm = norms_[column];
    return {std::move(pairs.omega), norm * norm * pairs.Q.row(0).transpose().cwiseAbs2()};
}

Eigen::MatrixXd KrylovSpaces::combine(const std::vector<Eigen::VectorXd>& coefficients) const {
    Eigen::MatrixXd Y(D_.size(), columns_);
    const std::vector<int>& inverse = cholesky_.inverseOrder();
    combineRows(coefficients, [&](Index i, const auto& row) { Y.row(inverse[i]) = row.matrix(); });
    return Y;
}

double KrylovSpaces::largestEntryOf(const std::vector<Eigen::VectorXd>& coefficients) const {
    std::vector<double> largest(
        static_cast<std::size_t>((D_.size() + kRowsOfTask - 1) / kRowsOfTask));
    combineRows(coefficients, [&](Index i, const auto& row) {
        double& ofTask = largest[i / kRowsOfTask];
        ofTask = std::max(ofTask, row.abs().maxCoeff());
    });
    return *std::max_element(largest.begin(), largest.end());
}

template <class TakeRow>
void KrylovSpaces::combineRows(const std::vector<Eigen::VectorXd>& coefficients,
                               const TakeRow& takeRow) const {
    switch (columns_) {
        case 1: return combineColumns<1>(coefficients, takeRow);
        case 2: return combineColumns<2>(coefficients, takeRow);
        case 3: return combineColumns<3>(coefficients, takeRow);
        default: return combineColumns<4>(coefficients, takeRow);
    }
}

template <int Columns, class TakeRow>
void KrylovSpaces::combineColumns(const std::vector<Eigen::VectorXd>& coefficients,
                                  const TakeRow& takeRow) const {
    // Filled up with zeros: spaces may have ended at different dimensions.
    std::vector<Row<Columns>> factors(basis_.size(), Row<Columns>::Zero());
    for (int c = 0; c < Columns; ++c)
        for (Index j = 0; j < coefficients[c].size(); ++j) factors[j][c] = coefficients[c][j];
    parallelRows(D_.size(), [&](Index begin, Index end) {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero((end - begin) * Columns);
        for (std::size_t j = 0; j < basis_.size(); ++j) {
            if ((factors[j] == 0.0).all()) continue;
            for (Index i = begin; i < end; ++i)
                rowOf<Columns>(sum, i - begin) += factors[j] * rowOf<Columns>(basis_[j], i);
        }
        for (Index i = begin; i < end; ++i) takeRow(i, rowOf<Columns>(sum, i - begin));
    });
}

}  // namespace spectral
