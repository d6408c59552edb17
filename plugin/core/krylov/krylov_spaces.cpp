#include "core/krylov/krylov_spaces.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/krylov/rows.h"
#include "core/support/dense_solvers.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Relative norm below which a new direction may be round-off.
constexpr double kBreakdown = 1e-13;

/// Inner product of orthogonalized vectors: a few units of round-off. A new direction of this
/// relative norm is pure round-off: the space is invariant. A larger one may carry all information
/// on vertices whose share of the mass is 1e-12.
constexpr double kRoundOff = 1e-15;

/// Number of tasks parallelRows splits the rows into.
std::size_t taskCount(Index rows) {
    return static_cast<std::size_t>((rows + kRowsPerTask - 1) / kRowsPerTask);
}

template <int Columns>
Row<Columns> lastEntries(const std::vector<std::vector<double>>& columns) {
    Row<Columns> last = Row<Columns>::Zero();
    for (int c = 0; c < Columns; ++c)
        if (!columns[c].empty()) last[c] = columns[c].back();
    return last;
}

/// A task's partial sum over consecutive rows of one component.
template <int Columns>
struct ComponentSum {
    int label;
    Row<Columns> sum;
};

template <int Columns>
struct Moments {
    /// D-weighted mean of every component, count x Columns.
    Eigen::Array<double, Eigen::Dynamic, Columns> means;
    Row<Columns> squares;  ///< Squared D-norms after removal of the means.
};

/// Moments of the rows returned by `row`. The squared norms are accurate only for small means,
/// because the squares of the means are subtracted.
template <int Columns, class MakeRow>
Moments<Columns> momentsOf(const Eigen::VectorXd& D, const Eigen::VectorXi& label,
                           const Eigen::VectorXd& mass, const MakeRow& row) {
    std::vector<std::vector<ComponentSum<Columns>>> parts(taskCount(D.size()));
    Moments<Columns> moments;
    moments.squares =
        parallelSum(D.size(), Row<Columns>::Zero().eval(), [&](Index begin, Index end) {
            std::vector<ComponentSum<Columns>>& sums = parts[begin / kRowsPerTask];
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

KrylovSpaces::KrylovSpaces(const KrylovOperator& S, const Laplacian& laplacian, const Signals& X,
                           double orthogonal, bool isKept)
    : S_(S),
      constants_(laplacian.constants),
      orthogonal_(orthogonal),
      columns_(static_cast<int>(X.cols())),
      D_(laplacian.D.size()),
      label_(laplacian.D.size()),
      isKept_(isKept),
      alpha_(X.cols()),
      beta_(X.cols()),
      ritz_(X.cols()),
      overlap_(X.cols()),
      overlapBefore_(X.cols()),
      exhausted_(X.cols()),
      mayBeRoundOff_(X.cols()),
      roundOff_(kBreakdown) {
    assert(columns_ >= 1 && columns_ <= kMaxSignals);
    for (Eigen::VectorXd* rows : {&newest_, &before_, &next_}) rows->resize(S.rows() * columns_);
    before_.setZero();
    const int* order = S.order();
    parallelRows(D_.size(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            D_[order[i]] = laplacian.D[i];
            label_[order[i]] = constants_.label()[i];
        }
    });
    withColumns(columns_, [&](auto columns) { start<columns>(X); });
}

bool KrylovSpaces::extend() {
    if (std::find(exhausted_.begin(), exhausted_.end(), false) == exhausted_.end()) return false;
    withColumns(columns_, [&](auto columns) { extendColumns<columns>(); });
    return true;
}

template <int Columns>
void KrylovSpaces::start(const Signals& X) {
    const Index n = D_.size();
    double* q = newest_.data();
    const int* order = S_.order();
    parallelRows(n, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) rowOf<Columns>(q, order[i]) = X.row(i).array();
    });
    const auto mean = momentsOf<Columns>(D_, label_, constants_.masses(), [&](Index i) {
                          return Row<Columns>(rowOf<Columns>(q, i));
                      }).means;
    std::vector<double> largest(taskCount(n));
    const Row<Columns> squares =
        parallelSum(n, Row<Columns>::Zero().eval(), [&](Index begin, Index end) {
            Row<Columns> sum = Row<Columns>::Zero(), taskMax = sum;
            for (Index i = begin; i < end; ++i) {
                auto x = rowOf<Columns>(q, i);
                if (label_[i] >= 0) x -= mean.row(label_[i]);
                sum += D_[i] * x * x;
                taskMax = taskMax.max(x.abs());
            }
            largest[begin / kRowsPerTask] = taskMax.maxCoeff();  // once: tasks share a cache line
            return sum;
        });
    norms_ = squares.sqrt().transpose();
    const Row<Columns> constants =
        (mean.square().colwise() * constants_.masses().array()).colwise().sum().sqrt();
    for (const double entry : largest) largestEntry_ = std::max(largestEntry_, entry);
    Row<Columns> inverse = Row<Columns>::Zero();
    for (int c = 0; c < Columns; ++c) {
        exhausted_[c] = !(norms_[c] > kBreakdown * constants[c]);  // what is left is round-off
        if (!exhausted_[c]) inverse[c] = 1.0 / norms_[c];
    }
    append<Columns>([&](Index i) {
        const Row<Columns> row = rowOf<Columns>(q, i) * inverse;
        rowOf<Columns>(q, i) = row;
        return row;
    });
}

/// Computes the rows of the newest vector and appends it to the basis.
template <int Columns, class MakeRow>
void KrylovSpaces::append(const MakeRow& row) {
    Eigen::VectorXd vector(isKept_ ? D_.size() * Columns : 0);
    parallelRows(D_.size(), [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const Row<Columns> values = row(i);
            if (isKept_) rowOf<Columns>(vector.data(), i) = values;
        }
    });
    if (isKept_) basis_.push_back(std::move(vector));
}

template <int Columns>
void KrylovSpaces::extendColumns() {
    const double *q = newest_.data(), *p = before_.data();
    double* w = next_.data();
    const Row<Columns> alpha = S_.apply(D_, q, Columns, w).transpose();

    // w = S q - alpha q - beta p, with p the vector before q. Constants arise only from round-off,
    // which every step would amplify.
    const Row<Columns> before = lastEntries<Columns>(beta_);
    const auto moments = momentsOf<Columns>(D_, label_, constants_.masses(), [&](Index i) {
        const Row<Columns> row =
            rowOf<Columns>(w, i) - (alpha * rowOf<Columns>(q, i) + before * rowOf<Columns>(p, i));
        rowOf<Columns>(w, i) = row;
        return row;
    });
    Eigen::Array<double, Eigen::Dynamic, Columns> constants =
        moments.means.colwise() * constants_.masses().array().sqrt();
    for (int c = 0; c < Columns; ++c)
        if (mayBeRoundOff_[c]) constants.col(c).setZero();  // unrelated to the signal
    roundOff_ = std::max(roundOff_, constants.matrix().norm() / S_.errorOf(S_.theta(0.0), 1.0));
    Row<Columns> beta = moments.squares.sqrt();
    for (int c = 0; c < Columns; ++c)
        if (!exhausted_[c]) alpha_[c].push_back(alpha[c]);
    if (isKept_ && losesOrthogonality(beta)) beta = orthogonalize<Columns>(beta, w);

    Row<Columns> inverse = Row<Columns>::Zero();
    for (int c = 0; c < Columns; ++c) {
        if (exhausted_[c]) continue;
        const double scale = std::hypot(alpha[c], before[c]);
        mayBeRoundOff_[c] = mayBeRoundOff_[c] || !(beta[c] > kBreakdown * scale);
        exhausted_[c] = !(beta[c] > kRoundOff * scale);
        if (exhausted_[c]) continue;
        beta_[c].push_back(beta[c]);
        inverse[c] = 1.0 / beta[c];
    }

    append<Columns>([&](Index i) {
        Row<Columns> row = rowOf<Columns>(w, i);
        if (label_[i] >= 0) row -= moments.means.row(label_[i]);
        row *= inverse;
        rowOf<Columns>(w, i) = row;
        return row;
    });
    before_.swap(newest_);
    newest_.swap(next_);
}

/// Whether the next vector must be orthogonalized. Updates the estimated inner products with all
/// other vectors by their own recurrence (Simon 1984). If so, the vector after next must be as
/// well: it inherits the errors of the current one.
bool KrylovSpaces::losesOrthogonality(const Eigen::Ref<const Eigen::ArrayXd>& beta) {
    bool loses = false;
    for (int c = 0; c < columns_; ++c) {
        if (exhausted_[c]) continue;
        const std::vector<double>&alpha = alpha_[c], &betas = beta_[c];
        const std::size_t j = alpha.size() - 1;
        std::vector<double>&now = overlap_[c], next(j + 2), &past = overlapBefore_[c];
        now.resize(j + 1, 1.0);
        // Round-off from cancellation between the terms of the recurrence.
        const double local = kRoundOff * std::max(1.0, std::abs(alpha[j]) / beta[c]);
        for (std::size_t k = 0; k < j; ++k) {
            double sum = betas[k] * now[k + 1] + (alpha[k] - alpha[j]) * now[k];
            if (k > 0) sum += betas[k - 1] * now[k - 1];
            sum = (sum - betas[j - 1] * past[k]) / beta[c];
            next[k] = sum + std::copysign(local, sum);
            loses = loses || !(std::abs(next[k]) <= orthogonal_);
        }
        next[j] = local;
        next[j + 1] = 1.0;
        loses = loses || !(local <= orthogonal_);
        past = std::move(now);
        now = std::move(next);
    }
    return std::exchange(orthogonalizesNext_, loses) || loses;
}

/// Orthogonalizes the rows of w against the basis; returns the norms of the columns.
template <int Columns>
Eigen::Array<double, 1, Columns> KrylovSpaces::orthogonalize(Eigen::Array<double, 1, Columns> norm,
                                                             double* w) {
    using Overlaps = Eigen::Array<double, Eigen::Dynamic, Columns>;
    const Index n = D_.size();
    const auto m = static_cast<Index>(basis_.size());
    for (int pass = 0; pass < 2; ++pass) {
        const Overlaps overlaps =
            parallelSum(n, Overlaps(Overlaps::Zero(m, Columns)), [&](Index begin, Index end) {
                Overlaps sums = Overlaps::Zero(m, Columns);
                for (Index j = 0; j < m; ++j) {
                    Row<Columns> sum = Row<Columns>::Zero();
                    for (Index i = begin; i < end; ++i)
                        sum += D_[i] * rowOf<Columns>(basis_[j].data(), i) * rowOf<Columns>(w, i);
                    sums.row(j) = sum;
                }
                return sums;
            });
        parallelRows(n, [&](Index begin, Index end) {
            for (Index j = 0; j < m; ++j) {
                const Row<Columns> overlap = overlaps.row(j);
                for (Index i = begin; i < end; ++i)
                    rowOf<Columns>(w, i) -= overlap * rowOf<Columns>(basis_[j].data(), i);
            }
        });
        const Row<Columns> squares =  // without the means, which are removed later
            momentsOf<Columns>(D_, label_, constants_.masses(), [&](Index i) {
                return Row<Columns>(rowOf<Columns>(w, i));
            }).squares;
        const Row<Columns> before = std::exchange(norm, squares.sqrt());
        if ((norm >= 0.5 * before).all()) break;  // otherwise cancellation requires a second pass
    }
    for (std::vector<double>& overlaps : overlap_)
        if (!overlaps.empty()) std::fill(overlaps.begin(), overlaps.end() - 1, kRoundOff);
    return norm;
}

const KrylovSpaces::Ritz& KrylovSpaces::ritz(int column) const {
    const auto m = static_cast<Index>(alpha_[column].size());
    Ritz& pairs = ritz_[column];
    if (pairs.omega.size() == m) return pairs;
    Eigen::VectorXd a = Eigen::Map<const Eigen::VectorXd>(alpha_[column].data(), m);
    Eigen::VectorXd b = Eigen::Map<const Eigen::VectorXd>(beta_[column].data(), m - 1);
    // Eigen scales a full matrix to entries up to 1, but not a tridiagonal one, although its
    // convergence test, |b| <= eps sqrt(|a|), assumes that scale.
    const double scale = std::max(a.cwiseAbs().maxCoeff(), m > 1 ? b.cwiseAbs().maxCoeff() : 0.0);
    if (scale > 0.0) {
        a /= scale;
        b /= scale;
    }
    auto [theta, Q] = tridiagonalPairs(a, b);
    pairs = {Eigen::VectorXd(m), std::move(Q)};
    for (Index i = 0; i < m; ++i) pairs.omega[i] = std::sqrt(S_.lambda(scale * theta[i]));
    return pairs;
}

Eigen::VectorXd KrylovSpaces::coefficients(int column, const Gain& gain) const {
    const Ritz& pairs = ritz(column);
    if (pairs.omega.size() == 0) return {};
    const Eigen::VectorXd gains = pairs.omega.unaryExpr(gain);
    // Kovnatsky et al. 2012, Eq. 6, with the Ritz values and vectors in place of the harmonics.
    return norms_[column] * (pairs.Q * gains.cwiseProduct(pairs.Q.row(0).transpose()));
}

double KrylovSpaces::squaredErrorBound(int column, const Eigen::VectorXd& c,
                                       const Eigen::VectorXd& omega,
                                       const Eigen::VectorXd& gains) const {
    constexpr double kHuge = 1e100;  // p_k grows geometrically where the signal has no energy
    if (exhausted_[column]) return 0.0;
    const std::vector<double>&alpha = alpha_[column], &beta = beta_[column];
    using Values = Eigen::ArrayXd;  // at all samples
    const Index count = omega.size();
    const double norm = norms_[column];
    const Values theta = omega.array().unaryExpr([&](double w) { return S_.theta(w * w); });
    Values before = Values::Zero(count), p = Values::Ones(count), polynomial = before,
           squares = before, unit = p;
    for (std::size_t k = 0; k < alpha.size(); ++k) {
        polynomial += c[static_cast<Index>(k)] / norm * p;
        squares += p.square();
        const double inverse = 1.0 / beta[k], coupled = k > 0 ? beta[k - 1] * inverse : 0.0;
        before = (theta - alpha[k]) * (inverse * p) - coupled * before;
        before.swap(p);
        if (!(p.abs().maxCoeff() > kHuge)) continue;
        const Values scale = (p.abs() > kHuge).select(1.0 / kHuge, Values::Ones(count));
        for (Values* values : {&before, &p, &polynomial, &unit}) *values *= scale;
        squares *= scale.square();
    }
    const Values mismatch = unit * gains.array() - polynomial;
    const Values bound = mismatch.square() / (squares + p.square());
    double sum = 0.0, largest = 0.0;
    for (Index s = 0; s < count; ++s) {
        // The last polynomial, p_m, changes sign at the Ritz values.
        if (s > 0 && (p[s] < 0.0) != (p[s - 1] < 0.0)) sum += std::exchange(largest, 0.0);
        largest = std::max(largest, bound[s]);
    }
    return norm * norm * (sum + largest);
}

Quadrature KrylovSpaces::quadrature(int column) const {
    const Ritz& pairs = ritz(column);
    if (pairs.omega.size() == 0) return {};
    const double norm = norms_[column];
    return {pairs.omega, norm * norm * pairs.Q.row(0).transpose().cwiseAbs2()};
}

Eigen::MatrixXd KrylovSpaces::combine(const std::vector<Eigen::VectorXd>& coefficients) const {
    return std::move(combineAll({coefficients}).front());
}

std::vector<Eigen::MatrixXd> KrylovSpaces::combineAll(
    const std::vector<std::vector<Eigen::VectorXd>>& sets) const {
    std::vector<Eigen::MatrixXd> Y(sets.size(), Eigen::MatrixXd(D_.size(), columns_));
    const int* inverse = S_.inverseOrder();
    withColumns(columns_, [&](auto columns) {
        combineColumns<columns>(
            sets, [&](std::size_t set, Index i, const auto& row) { Y[set].row(inverse[i]) = row; });
    });
    return Y;
}

double KrylovSpaces::largestEntryOf(const std::vector<Eigen::VectorXd>& coefficients) const {
    std::vector<double> largest(taskCount(D_.size()));
    withColumns(columns_, [&](auto columns) {
        combineColumns<columns>({coefficients}, [&](std::size_t, Index i, const auto& row) {
            double& taskMax = largest[i / kRowsPerTask];
            taskMax = std::max(taskMax, row.cwiseAbs().maxCoeff());
        });
    });
    return *std::max_element(largest.begin(), largest.end());
}

/// Calls takeRow(set, i, row) with each row of each combination.
template <int Columns, class TakeRow>
void KrylovSpaces::combineColumns(const std::vector<std::vector<Eigen::VectorXd>>& sets,
                                  const TakeRow& takeRow) const {
    constexpr Index kRows = 64;  // the sums of a dozen sets stay in a core's cache
    using Block = Eigen::Matrix<double, kRows, Columns>;
    // Padded with zeros, as spaces may differ in dimension.
    std::vector<Row<Columns>> factors(basis_.size() * sets.size(), Row<Columns>::Zero());
    for (std::size_t set = 0; set < sets.size(); ++set)
        for (int c = 0; c < Columns; ++c)
            for (Index j = 0; j < sets[set][c].size(); ++j)
                factors[j * sets.size() + set][c] = sets[set][c][j];
    parallelRows(D_.size(), [&](Index begin, Index end) {
        std::vector<Block> sums(sets.size());
        Block vector = Block::Zero();
        for (Index from = begin; from < end; from += kRows) {
            const Index count = std::min(kRows, end - from);
            for (Block& sum : sums) sum.setZero();
            for (std::size_t j = 0; j < basis_.size(); ++j) {
                for (Index i = 0; i < count; ++i)
                    vector.row(i) = rowOf<Columns>(basis_[j].data(), from + i).matrix();
                for (std::size_t set = 0; set < sets.size(); ++set) {
                    const Row<Columns>& factor = factors[j * sets.size() + set];
                    for (int c = 0; c < Columns; ++c) sums[set].col(c) += factor[c] * vector.col(c);
                }
            }
            for (std::size_t set = 0; set < sets.size(); ++set)
                for (Index i = 0; i < count; ++i) takeRow(set, from + i, sums[set].row(i));
        }
    });
}

}  // namespace spectral
