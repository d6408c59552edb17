#include "core/krylov/series_evaluation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/krylov/chebyshev_series.h"
#include "core/krylov/rows.h"
#include "core/krylov/series_operators.h"
#include "core/support/memory.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

using series::Centred;
using series::kRoundOff;
using series::Product;
using series::Solve;

/// Number of nodes that a gain is first tried with, and the largest one.
constexpr int kMinNodes = 32, kMaxNodes = 2048;

/// Number of solves beyond which a Lanczos space, which adapts to the signal, is tried instead. Up
/// to 66 (Butterworth of order 8 on a dragon) series took less time; gains with cusps take
/// hundreds.
constexpr int kMaxSolves = 80;

/// Share of the accuracy for round-off, and for gains between the nodes; half is left for the
/// terms.
constexpr double kShareOfOthers = 0.25;

/// Number of gains at once: each has a sum that every term is added to.
constexpr std::size_t kMaxGains = 3;

/// Signals without their constants, and their details T_0 = (S - theta_0) X / theta_max.
struct Details {
    double shape = 0.0, norm = 0.0;            ///< D-norms of the signals and of the details.
    double largestEntry = 0.0, largest = 0.0;  ///< Largest entries of both.
    /// Of S, relative: the constant part of the details, which should be 0.
    double roundOff = 0.0;

    Details& operator+=(const Details& other) {
        shape += other.shape;
        norm += other.norm;
        largestEntry = std::max(largestEntry, other.largestEntry);
        largest = std::max(largest, other.largest);
        return *this;
    }
};

/// A gain as a series in t = theta / theta_max, from 0 to 1.
struct GainSeries {
    ChebyshevSeries series;
    double atZero;           ///< F(0).
    double mismatch;         ///< Error of the series at the samples, relative, over the surface.
    double truncated = 0.0;  ///< Requested truncation error, relative to the signals.

    double coefficient(int k) const {
        const std::vector<double>& c = series.coefficients();
        return static_cast<std::size_t>(k) < c.size() ? c[k] : 0.0;
    }
    /// Sum of the moduli of the coefficients from the k-th on.
    double tail(int k) const {
        return series.tail(std::min(static_cast<std::size_t>(k), series.coefficients().size()));
    }
    /// Round-off of the sum relative to that of a term, which grows like a random walk.
    double growth() const {
        double sum = 0.0;
        for (std::size_t k = 0; k < series.coefficients().size(); ++k)
            sum += std::sqrt(static_cast<double>(k + 1)) * std::abs(series.coefficients()[k]);
        return sum;
    }
};

/// The series of F(sqrt(A)) X to a relative error of `accuracy` over the surface; empty if it
/// has more than `most` terms.
std::optional<GainSeries> seriesOf(const Gain& gain, const KrylovOperator& S,
                                   const Eigen::VectorXd& omega, const Details& details,
                                   double accuracy, std::optional<int> most) {
    const double first = S.theta(0.0), last = S.theta(S.lastFrequency() * S.lastFrequency());
    const double scale = std::max(first, last), t0 = first / scale, atZero = gain(0.0);
    const auto remainder = [&](double t) {
        return (gain(std::sqrt(S.lambda(t * scale))) - atZero) / (t - t0);
    };
    const double target =
        accuracy * details.shape / std::max(details.norm, std::numeric_limits<double>::min());
    const auto mismatchOf = [&](const ChebyshevSeries& series) {
        double largest = 0.0;
        for (const double frequency : omega) {
            const double t = S.theta(frequency * frequency) / scale;
            if (t == t0) continue;
            largest =
                std::max(largest, std::abs(series(t) - remainder(t)) *
                                      std::min(details.norm / details.shape, std::abs(t - t0)));
        }
        return largest;
    };
    for (int nodes = kMinNodes;; nodes *= 2) {
        GainSeries result{ChebyshevSeries(remainder, 0.0, 1.0, nodes), atZero, 0.0};
        if (!std::isfinite(result.tail(0))) return {};
        const int length = result.series.lengthFor(target);
        if (length <= nodes / 2 || nodes == kMaxNodes) result.mismatch = mismatchOf(result.series);
        if (length <= nodes / 2 && result.mismatch <= kShareOfOthers * accuracy) {
            if (most && length > *most) return {};
            return result;
        }
        if (most && std::min(length, nodes / 2) > *most) return {};
        if (nodes == kMaxNodes) return most ? std::nullopt : std::optional(std::move(result));
    }
}

/// Errors of sums of terms, relative to the signals.
class Errors {
  public:
    /// @param ofTerm  round-off of a term, relative to its size.
    Errors(const Details& details, const FullSpectrumOptions& options, double ofTerm)
        : norm_(std::max(details.norm / details.shape, kRoundOff)),
          largestEntry_(details.largestEntry),
          atEveryVertex_(options.atEveryVertex),
          ofTerm_(ofTerm),
          ofS_(std::max({options.roundOff, details.roundOff, kRoundOff})),
          ofSAtVertices_(std::max(ofS_, options.roundOffAtVertices.value_or(0.0))) {}

    /// Error caused by the terms from the k-th on.
    /// @param largest  largest entry of any term.
    double truncation(const GainSeries& gain, int k, double largest) const {
        return gain.tail(k) * sizeOfTerms(largest);
    }

    /// Error caused by round-off in the terms, in S, and by gains between the nodes.
    double others(const GainSeries& gain, double largest) const {
        const double size = sizeOfTerms(largest);
        const double ofS = atEveryVertex_ ? ofSAtVertices_ : ofS_;
        return gain.mismatch * size / norm_ + ofS * gain.tail(0) +
               std::max(ofTerm_, ofS) * gain.growth() * size;
    }

  private:
    double sizeOfTerms(double largest) const {
        return atEveryVertex_ ? std::max(norm_, largest / largestEntry_) : norm_;
    }
    double norm_, largestEntry_;
    bool atEveryVertex_;
    double ofTerm_, ofS_, ofSAtVertices_;
};

/// The terms T_k(x) T_0 of a series, with x the operator S, shifted and scaled to eigenvalues from
/// -1 to 1, and their sums for several gains.
template <class Operator>
class Terms {
  public:
    Terms(const Laplacian& laplacian, const KrylovOperator& S, const Signals& X,
          const Centred& centred)
        : operator_(laplacian, S, X, centred),
          count_(laplacian.D.size()),
          newest_(static_cast<std::size_t>(S.rows()), Values::Zero()) {
        start(laplacian, centred, X.cols());
    }

    const Details& details() const { return details_; }

    /// Sums the terms until all truncation errors are as requested, or the coefficients end.
    /// @param largest  largest entry of any term: that of T_0 at first.
    /// @return         number of terms.
    int add(const std::vector<GainSeries>& series, const Errors& errors, double& largest,
            const Progress& progress) {
        const auto isLast = [&](const GainSeries& gain, int k) {
            return gain.tail(k) == 0.0 || errors.truncation(gain, k, largest) <= gain.truncated;
        };
        int last = 1;  // as far as T_0 tells
        for (const GainSeries& gain : series)
            while (!isLast(gain, last)) ++last;
        before_.assign(newest_.size(), Values::Zero());
        sums_.resize(series.size());
        for (Rows& sum : sums_) sum.assign(newest_.size(), Values::Zero());
        for (int k = 1;; ++k) {
            progress.report(std::min(1.0, static_cast<double>(k) / last), "filtering");
            largest = std::max(largest, unit_ * next(k, series));
            if (!std::all_of(series.begin(), series.end(),
                             [&](const GainSeries& gain) { return isLast(gain, k + 1); }))
                continue;
            if (k % 2 == 0) addNewest(k, series);
            for (Rows* rows : {&newest_, &before_}) Rows().swap(*rows);
            operator_.release();
            return k + 1;
        }
    }

    double sum(std::size_t g, Index vertex, Index column) const {
        return unit_ * sums_[g][operator_.rowOf(vertex)][column];
    }
    void release(std::size_t g) { Rows().swap(sums_[g]); }  ///< Frees the memory of a sum.

  private:
    using Values = typename Operator::Values;
    using Scalar = typename Values::Scalar;
    using Rows = std::vector<Values, Eigen::aligned_allocator<Values>>;

    /// T_0 and what is known from it.
    void start(const Laplacian& laplacian, const Centred& centred, Index columns) {
        const Eigen::VectorXd& D = laplacian.D;
        details_ = parallelSum(count_, Details(), [&](Index begin, Index end) {
            Details sums;
            for (Index i = begin; i < end; ++i)
                for (Index c = 0; c < columns; ++c) {
                    const double x = centred(i, c);
                    sums.shape += D[i] * x * x;
                    sums.largestEntry = std::max(sums.largestEntry, std::abs(x));
                }
            return sums;
        });
        if (details_.largestEntry > 0.0) unit_ = details_.largestEntry;
        details_ += parallelSum(count_, Details(), [&](Index begin, Index end) {
            Details sums;
            for (Index i = begin; i < end; ++i) {
                const typename Operator::Detail row = operator_.detail(i);
                sums.norm += D[i] * row.matrix().squaredNorm();
                sums.largest = std::max(sums.largest, row.abs().maxCoeff());
                newest_[operator_.rowOf(i)] = (row / unit_).template cast<Scalar>();
            }
            return sums;
        });
        details_.shape = std::sqrt(details_.shape);
        details_.norm = std::sqrt(details_.norm);
        if constexpr (Operator::kKeepsConstants) return;
        Eigen::MatrixXd T0(count_, columns);
        for (Index i = 0; i < count_; ++i)
            for (Index c = 0; c < columns; ++c) T0(i, c) = unit_ * newest_[operator_.rowOf(i)][c];
        const Eigen::MatrixXd means = laplacian.constants.means(laplacian.D, T0);
        details_.roundOff = (laplacian.constants.masses().cwiseSqrt().asDiagonal() * means).norm() /
                            std::max(details_.shape, std::numeric_limits<double>::min());
    }

    /// T_k = 2 x T_k-1 - T_k-2, T_1 = x T_0. Every second term is added to the sums together with
    /// the one before: sums are a third of what a term reads and writes.
    /// @return  the largest entry of T_k.
    double next(int k, const std::vector<GainSeries>& series) {
        switch (k % 2 == 1 ? series.size() : 0) {
            case 0: return nextRows<0>(k, series);
            case 1: return nextRows<1>(k, series);
            case 2: return nextRows<2>(k, series);
            default: return nextRows<kMaxGains>(k, series);
        }
    }

    template <std::size_t Gains>
    double nextRows(int k, const std::vector<GainSeries>& series) {
        struct Sum {
            Scalar ofHere, ofRow;
            Values* rows;
        };
        std::array<Sum, Gains> all;
        for (std::size_t g = 0; g < Gains; ++g)
            all[g] = {static_cast<Scalar>(series[g].coefficient(k - 1)),
                      static_cast<Scalar>(series[g].coefficient(k)), sums_[g].data()};
        const auto applied = operator_.twice(newest_.data());
        const double largest = parallelMax(count_, [&](Index begin, Index end) {
            const auto twice = applied;  // copies: stores might change what others refer to
            const auto sums = all;
            const Scalar factor = k == 1 ? 1 : 2, ofBefore = k == 1 ? 0 : 1;
            const Values* newest = newest_.data();
            Values* before = before_.data();
            Values most = Values::Zero();
            for (Index i = begin; i < end; ++i) {
                const Values here = newest[i],
                             row = factor * (twice(i) - here) - ofBefore * before[i];
                before[i] = row;
                most = most.max(row.abs());
                for (const Sum& sum : sums) sum.rows[i] += sum.ofHere * here + sum.ofRow * row;
            }
            return static_cast<double>(most.maxCoeff());
        });
        newest_.swap(before_);
        return largest;
    }

    void addNewest(int k, const std::vector<GainSeries>& series) {
        for (std::size_t g = 0; g < sums_.size(); ++g) {
            const auto factor = static_cast<Scalar>(series[g].coefficient(k));
            parallelRows(count_, [&](Index begin, Index end) {
                for (Index i = begin; i < end; ++i) sums_[g][i] += factor * newest_[i];
            });
        }
    }

    Operator operator_;
    Index count_;
    double unit_ = 1.0;  // of the rows
    Details details_;
    Rows newest_, before_;
    std::vector<Rows> sums_;
};

/// As applySeries; nothing if round-off takes too much of the accuracy and that is not allowed.
template <class Operator>
std::optional<std::vector<FullSpectrumResult>> evaluate(
    const Laplacian& laplacian, const KrylovOperator& S, const std::vector<Gain>& gains,
    const Signals& X, const Eigen::VectorXd& omega, const FullSpectrumOptions& options,
    bool mayRoundOff, const Progress& progress) {
    // Two terms, and a sum and a result for each gain.
    const double count = static_cast<double>(gains.size()),
                 bytes = Operator::kBytesOfRow + sizeof(typename Operator::Values) * (2.0 + count) +
                         sizeof(double) * static_cast<double>(X.cols()) * count;
    requireMemory(bytes * static_cast<double>(X.rows()), X.rows());
    const Centred centred(X, laplacian);
    Terms<Operator> terms(laplacian, S, X, centred);
    const Details& details = terms.details();
    if (!(details.largestEntry > 0.0))
        return std::vector<FullSpectrumResult>(gains.size(), {X, 0.0, 0, true});

    // How much larger errors are at the vertices than over the surface is known only at the end.
    constexpr double kAtVertices = 1e-2;
    const double share = options.atEveryVertex ? kAtVertices : 1.0;
    const std::optional<int> most = S.isProduct() ? options.affordable : kMaxSolves;
    const auto accuracyOf = [&](std::size_t gain) {
        return gain == gains.size() / 2 ? options.accuracy
                                        : std::max(options.accuracy, options.accuracyOfOthers);
    };
    const Errors errors(details, options, Operator::kRoundOffOfTerm);
    std::vector<GainSeries> series;
    for (std::size_t g = 0; g < gains.size(); ++g) {
        const double accuracy = accuracyOf(g);
        auto found = seriesOf(gains[g], S, omega, details, share * accuracy, most);
        if (!found) return std::vector<FullSpectrumResult>();
        const double others = errors.others(*found, details.largest);
        if (!mayRoundOff && others - found->mismatch > kShareOfOthers * accuracy) return {};
        // At the vertices the bound is often reached, and steps add up: one term more, of some 12.
        found->truncated =
            options.atEveryVertex ? 0.25 * accuracy : std::max(accuracy - others, 0.5 * accuracy);
        series.push_back(*std::move(found));
    }
    double largest = details.largest;
    const int length = terms.add(series, errors, largest, progress);

    std::vector<FullSpectrumResult> results(gains.size());
    for (std::size_t g = 0; g < gains.size(); ++g) {
        FullSpectrumResult& result = results[g];
        result.Y.resize(X.rows(), X.cols());
        parallelRows(X.rows(), [&](Index begin, Index end) {
            for (Index c = 0; c < X.cols(); ++c)
                for (Index i = begin; i < end; ++i)
                    result.Y(i, c) = series[g].atZero * centred(i, c) + terms.sum(g, i, c);
        });
        terms.release(g);
        laplacian.constants.add(centred.means() - laplacian.constants.means(laplacian.D, result.Y),
                                result.Y);
        result.dimension = length;
        result.errorEstimate =
            errors.truncation(series[g], length, largest) + errors.others(series[g], largest);
        result.converged = result.errorEstimate <= accuracyOf(g);
        if (!result.converged) result.errorEstimate *= kNotConverged;
    }
    return results;
}

}  // namespace

std::vector<FullSpectrumResult> applySeries(const Laplacian& laplacian, const KrylovOperator& S,
                                            const std::vector<Gain>& gains, const Signals& X,
                                            const Eigen::VectorXd& omega,
                                            const FullSpectrumOptions& options,
                                            const Progress& progress) {
    if (gains.size() > kMaxGains) return {};
    const auto withSolves = [&](auto columns) {
        return evaluate<Solve<columns>>(laplacian, S, gains, X, omega, options, false, progress)
            .value_or(std::vector<FullSpectrumResult>());
    };
    constexpr std::integral_constant<int, kMaxSignals> few;
    constexpr std::integral_constant<int, kMaxSignalsOfSeries> many;
    const bool areFew = X.cols() <= few;
    if (!S.isProduct())
        return areFew ? withColumns(static_cast<int>(X.cols()), withSolves) : withSolves(many);
    // At every vertex results must not depend on how signals are shifted, beyond their own
    // rounding.
    if (areFew && !options.atEveryVertex)
        if (auto results = evaluate<Product<float, few>>(laplacian, S, gains, X, omega, options,
                                                         false, progress))
            return *std::move(results);
    const auto withProducts = [&](auto columns) {
        return *evaluate<Product<double, columns>>(laplacian, S, gains, X, omega, options, true,
                                                   progress);
    };
    return areFew ? withProducts(few) : withProducts(many);
}

}  // namespace spectral
