#include "core/krylov/series_evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "core/krylov/chebyshev_series.h"
#include "core/krylov/rows.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Number of nodes that a gain is first tried with, and the largest one.
constexpr int kMinNodes = 32, kMaxNodes = 2048;

/// Round-off of a term, relative to its size.
constexpr double kSingleRoundOff = 6e-8, kDoubleRoundOff = 1e-15;

/// Number of solves beyond which a Lanczos space, which adapts to the signal, is tried instead. A
/// tenth of a Gaussian, as accurate as ten steps have it, takes 13 on a dragon (Lanczos: 20); a
/// whole one to 1e-7 takes 16 on a blob of few frequencies (Lanczos: 8).
constexpr int kMaxSolves = 14;

/// Number of gains at once: each has a sum that every term is added to.
constexpr std::size_t kMaxGains = 3;

/// Signals without their constants, and their details T_0 = (S - theta_0) X / theta_max.
struct Details {
    double shape = 0.0, norm = 0.0;            ///< D-norms of the signals and of the details.
    double largestEntry = 0.0, largest = 0.0;  ///< Largest entries of both.
    double roundOff =
        0.0;  ///< Of S, relative: the constant part of the details, which should be 0.

    Details& operator+=(const Details& other) {
        shape += other.shape;
        norm += other.norm;
        largestEntry = std::max(largestEntry, other.largestEntry);
        largest = std::max(largest, other.largest);
        return *this;
    }
};

/// Signals X (n x c) without the means of their components.
class Centred {
  public:
    Centred(const Eigen::MatrixXd& X, const ConstantModes& constants)
        : X_(X), label_(constants.label()), means_(constants.means(X)) {}
    double operator()(Index i, Index c) const {
        return label_[i] < 0 ? X_(i, c) : X_(i, c) - means_(label_[i], c);
    }
    const Eigen::MatrixXd& means() const { return means_; }

  private:
    const Eigen::MatrixXd& X_;
    const Eigen::VectorXi& label_;
    Eigen::MatrixXd means_;
};

/// The terms T_k(x) T_0 of a series, with x the operator S, shifted and scaled to eigenvalues from
/// -1 to 1, and their sums for several gains.
class Terms {
  public:
    virtual ~Terms() = default;

    /// Computes T_0 and releases what only this needs.
    virtual Details start() = 0;

    /// Computes T_k, k >= 1, and adds it times factor[g] to each sum; starts the sums with T_0
    /// times start[g] if k is 1. Returns the largest entry of T_k.
    virtual double next(int k, const std::vector<double>& factor,
                        const std::vector<double>& start) = 0;

    virtual double sum(std::size_t g, Index vertex, Index column) const = 0;
    virtual void release(std::size_t g) = 0;  ///< Frees the memory of a sum.
};

/// T_k = 2 x T_k-1 - T_k-2, T_1 = x T_0.
struct Recurrence {
    explicit Recurrence(int k) : factor(k == 1 ? 1.0 : 2.0), last(k == 1 ? 0.0 : 1.0) {}
    double factor, last;
};

/// In single precision, for S = A / largest.
class SingleTerms final : public Terms {
  public:
    SingleTerms(const Laplacian& laplacian, double largest, const Eigen::MatrixXd& X,
                const Centred& centred, std::size_t gains)
        : laplacian_(laplacian), largest_(largest), X_(X), centred_(centred), sums_(gains) {}

    Details start() override {
        const Eigen::VectorXd& D = laplacian_.D;
        const Index n = D.size(), columns = X_.cols();
        for (Rows* rows : {&newest_, &before_}) rows->resize(static_cast<std::size_t>(n));
        for (Rows& sum : sums_) sum.resize(static_cast<std::size_t>(n));
        scale_.resize(static_cast<std::size_t>(n));
        if (laplacian_.constants.label().minCoeff() < 0) excess_.resize(scale_.size());
        Details details = parallelSum(n, Details(), [&](Index begin, Index end) {
            Details sums;
            for (Index i = begin; i < end; ++i)
                for (Index c = 0; c < columns; ++c) {
                    const double x = centred_(i, c);
                    sums.shape += D[i] * x * x;
                    sums.largestEntry = std::max(sums.largestEntry, std::abs(x));
                }
            return sums;
        });
        unit_ = details.largestEntry > 0.0 ? details.largestEntry : 1.0;
        details += parallelSum(n, Details(), [&](Index begin, Index end) {
            Details sums;
            for (Index i = begin; i < end; ++i) {
                Values row = Values::Zero();
                const double rowSum = rowSumOf(i), inverse = 1.0 / (D[i] * largest_);
                for (Index c = 0; c < columns; ++c) {
                    double b = rowSum * X_(i, c);
                    for (SparseMatrix::InnerIterator entry(laplacian_.W, i); entry; ++entry)
                        b += entry.value() * (X_(entry.row(), c) - X_(i, c));
                    b *= inverse;
                    sums.norm += D[i] * b * b;
                    sums.largest = std::max(sums.largest, std::abs(b));
                    row[c] = static_cast<float>(b / unit_);
                }
                newest_[i] = row;
                scale_[i] = static_cast<float>(2.0 * inverse);
                if (!excess_.empty()) excess_[i] = static_cast<float>(rowSum);
            }
            return sums;
        });
        details.shape = std::sqrt(details.shape);
        details.norm = std::sqrt(details.norm);
        return details;
    }

    double next(int k, const std::vector<double>& factor,
                const std::vector<double>& start) override {
        const double largest = parallelMax(laplacian_.D.size(), [&](Index begin, Index end) {
            for (std::size_t g = 0; k == 1 && g < sums_.size(); ++g)
                for (Index i = begin; i < end; ++i)
                    sums_[g][i] = static_cast<float>(start[g]) * newest_[i];
            switch (sums_.size()) {
                case 1: return nextRows<1>(k, factor, begin, end);
                case 2: return nextRows<2>(k, factor, begin, end);
                default: return nextRows<3>(k, factor, begin, end);
            }
        });
        newest_.swap(before_);
        return unit_ * largest;
    }

    double sum(std::size_t g, Index vertex, Index column) const override {
        return unit_ * sums_[g][vertex][column];
    }
    void release(std::size_t g) override { Rows().swap(sums_[g]); }

  private:
    using Values = Eigen::Array4f;
    using Rows = std::vector<Values, Eigen::aligned_allocator<Values>>;
    static_assert(kMaxSignals == Values::RowsAtCompileTime);

    /// Sum of a row of W: 0, except beside a fixed boundary.
    double rowSumOf(Index i) const {
        double sum = 0.0;
        if (excess_.empty()) return sum;
        for (SparseMatrix::InnerIterator entry(laplacian_.W, i); entry; ++entry)
            sum += entry.value();
        return sum;
    }

    template <std::size_t Gains>
    double nextRows(int k, const std::vector<double>& factor, Index begin, Index end) {
        const Recurrence recurrence(k);
        const auto a = static_cast<float>(recurrence.factor),
                   last = static_cast<float>(recurrence.last);
        float factors[Gains];
        Values* sums[Gains];
        for (std::size_t g = 0; g < Gains; ++g) {
            factors[g] = static_cast<float>(factor[g]);
            sums[g] = sums_[g].data();
        }
        const Values* newest = newest_.data();
        Values* before = before_.data();
        const auto* starts = laplacian_.W.outerIndexPtr();
        const auto* neighbours = laplacian_.W.innerIndexPtr();
        const double* weights = laplacian_.W.valuePtr();
        Values most = Values::Zero();
        for (Index i = begin; i < end; ++i) {
            const Values here = newest[i];
            Values sum = Values::Zero();  // of differences, so that constants stay exactly 0
            for (auto e = starts[i]; e < starts[i + 1]; ++e)
                sum += static_cast<float>(weights[e]) * (newest[neighbours[e]] - here);
            if (!excess_.empty()) sum += excess_[i] * here;
            Values row = a * (scale_[i] * sum - here);
            if (k > 1) row -= last * before[i];
            before[i] = row;
            most = most.max(row.abs());
            for (std::size_t g = 0; g < Gains; ++g) sums[g][i] += factors[g] * row;
        }
        return most.maxCoeff();
    }

    const Laplacian& laplacian_;
    double largest_, unit_ = 1.0;
    const Eigen::MatrixXd& X_;
    const Centred& centred_;
    Rows newest_, before_;
    std::vector<Rows> sums_;
    std::vector<float> scale_;   // 2 / (D_ii largest)
    std::vector<float> excess_;  // row sums of W, if there is a fixed boundary
};

/// In double precision, for any S.
class DoubleTerms final : public Terms {
  public:
    DoubleTerms(const Laplacian& laplacian, const KrylovOperator& S, const Eigen::MatrixXd& X,
                const Centred& centred, std::size_t gains)
        : constants_(laplacian.constants),
          S_(S),
          scale_(1.0 / std::max(S.theta(0.0), S.theta(S.lastFrequency() * S.lastFrequency()))),
          columns_(static_cast<int>(X.cols())),
          D_(laplacian.D.size()),
          sums_(gains) {
        for (Eigen::VectorXd* rows : {&newest_, &before_, &next_})
            rows->setZero(S.rows() * columns_);
        for (Eigen::VectorXd& sum : sums_) sum.resize(D_.size() * columns_);
        parallelRows(D_.size(), [&](Index begin, Index end) {
            for (Index i = begin; i < end; ++i) {
                const Index row = S.order()[i];
                D_[row] = laplacian.D[i];
                for (int c = 0; c < columns_; ++c) before_[row * columns_ + c] = centred(i, c);
            }
        });
    }

    Details start() override {
        S_.apply(D_, before_.data(), columns_, newest_.data());
        const double atZero = scale_ * S_.theta(0.0);
        Details details = parallelSum(D_.size(), Details(), [&](Index begin, Index end) {
            Details sums;
            for (Index k = begin * columns_; k < end * columns_; ++k) {
                const double x = before_[k], b = scale_ * newest_[k] - atZero * x;
                newest_[k] = b;
                sums.shape += D_[k / columns_] * x * x;
                sums.norm += D_[k / columns_] * b * b;
                sums.largestEntry = std::max(sums.largestEntry, std::abs(x));
                sums.largest = std::max(sums.largest, std::abs(b));
            }
            return sums;
        });
        details.shape = std::sqrt(details.shape);
        details.norm = std::sqrt(details.norm);
        Eigen::MatrixXd T0(D_.size(), columns_);
        for (Index i = 0; i < D_.size(); ++i)
            for (int c = 0; c < columns_; ++c) T0(i, c) = newest_[S_.order()[i] * columns_ + c];
        const Eigen::MatrixXd means = constants_.means(T0);
        details.roundOff = (constants_.masses().cwiseSqrt().asDiagonal() * means).norm() /
                           std::max(details.shape, std::numeric_limits<double>::min());
        return details;
    }

    double next(int k, const std::vector<double>& factor,
                const std::vector<double>& start) override {
        const Recurrence recurrence(k);
        S_.apply(D_, newest_.data(), columns_, next_.data());
        const double largest = parallelMax(D_.size(), [&](Index begin, Index end) {
            double most = 0.0;
            for (Index i = begin * columns_; i < end * columns_; ++i) {
                const double here = newest_[i];
                const double term = recurrence.factor * (2.0 * scale_ * next_[i] - here) -
                                    recurrence.last * before_[i];
                before_[i] = term;
                most = std::max(most, std::abs(term));
                for (std::size_t g = 0; g < sums_.size(); ++g)
                    sums_[g][i] = (k == 1 ? start[g] * here : sums_[g][i]) + factor[g] * term;
            }
            return most;
        });
        newest_.swap(before_);
        return largest;
    }

    double sum(std::size_t g, Index vertex, Index column) const override {
        return sums_[g][S_.order()[vertex] * columns_ + column];
    }
    void release(std::size_t g) override { sums_[g].resize(0); }

  private:
    const ConstantModes& constants_;
    const KrylovOperator& S_;
    double scale_;  // 1 / theta_max
    int columns_;
    Eigen::VectorXd D_, newest_, before_, next_;  // in the order of S
    std::vector<Eigen::VectorXd> sums_;
};

/// A gain as a series in t = theta / theta_max, from 0 to 1.
struct GainSeries {
    ChebyshevSeries series;
    double atZero;    ///< F(0).
    double mismatch;  ///< Error of the series at the samples, relative, over the surface.

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
    for (int nodes = kMinNodes;; nodes *= 2) {
        GainSeries result{ChebyshevSeries(remainder, 0.0, 1.0, nodes), atZero, 0.0};
        if (!std::isfinite(result.tail(0))) return {};
        for (const double frequency : omega) {
            const double t = S.theta(frequency * frequency) / scale;
            if (t == t0) continue;
            const double mismatch = std::abs(result.series(t) - remainder(t));
            result.mismatch =
                std::max(result.mismatch,
                         mismatch * std::min(details.norm / details.shape, std::abs(t - t0)));
        }
        const int length = result.series.lengthFor(target);
        if (length <= nodes / 2 && result.mismatch <= accuracy) {
            if (most && length > *most) return {};
            return result;
        }
        if (most && nodes / 2 > *most) return {};
        if (nodes == kMaxNodes) return most ? std::nullopt : std::optional(std::move(result));
    }
}

/// Errors of sums of terms, relative to the signals.
class Errors {
  public:
    Errors(const Details& details, const FullSpectrumOptions& options, bool isSingle)
        : norm_(std::max(details.norm / details.shape, kDoubleRoundOff)),
          largestEntry_(details.largestEntry),
          atEveryVertex_(options.atEveryVertex),
          ofTerm_(isSingle ? kSingleRoundOff : kDoubleRoundOff),
          ofS_(std::max({options.roundOff, details.roundOff, kDoubleRoundOff})),
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

/// Sums the terms until all truncation errors are within the accuracy, or the coefficients end.
/// @param largest  largest entry of any term: that of T_0 at first.
/// @return         number of terms.
int sumTerms(Terms& terms, const std::vector<GainSeries>& series, const Errors& errors,
             double accuracy, double& largest, const Progress& progress) {
    const auto coefficients = [&](int k) {
        std::vector<double> c;
        for (const GainSeries& gain : series) c.push_back(gain.coefficient(k));
        return c;
    };
    const auto isLast = [&](const GainSeries& gain, int k) {
        return gain.tail(k) == 0.0 || errors.truncation(gain, k, largest) <= accuracy;
    };
    int last = 1;  // as far as T_0 tells
    for (const GainSeries& gain : series)
        while (!isLast(gain, last)) ++last;
    for (int k = 1;; ++k) {
        progress.report(std::min(1.0, static_cast<double>(k) / last), "filtering");
        largest = std::max(largest, terms.next(k, coefficients(k), coefficients(0)));
        if (std::all_of(series.begin(), series.end(),
                        [&](const GainSeries& gain) { return isLast(gain, k + 1); }))
            return k + 1;
    }
}

}  // namespace

std::vector<FullSpectrumResult> applySeries(const Laplacian& laplacian, const KrylovOperator& S,
                                            const std::vector<Gain>& gains,
                                            const Eigen::MatrixXd& X, const Eigen::VectorXd& omega,
                                            const FullSpectrumOptions& options,
                                            const Progress& progress) {
    if (gains.size() > kMaxGains) return {};
    const Centred centred(X, laplacian.constants);
    bool isSingle = S.isProduct() && !options.atEveryVertex;
    const std::optional<int> most = S.isProduct() ? options.affordable : kMaxSolves;
    const auto newTerms = [&]() -> std::unique_ptr<Terms> {
        if (!isSingle) return std::make_unique<DoubleTerms>(laplacian, S, X, centred, gains.size());
        const double largest = S.lastFrequency() * S.lastFrequency();
        return std::make_unique<SingleTerms>(laplacian, largest, X, centred, gains.size());
    };
    std::unique_ptr<Terms> terms = newTerms();
    const Details details = terms->start();
    if (!(details.largestEntry > 0.0)) return {gains.size(), {X, 0.0, 0, true}};

    // How much larger errors are at the vertices than over the surface is known only at the end.
    constexpr double kAtVertices = 1e-2;
    const double share = options.atEveryVertex ? kAtVertices : 1.0;
    std::vector<GainSeries> series;
    for (const Gain& gain : gains) {
        auto found = seriesOf(gain, S, omega, details, share * options.accuracy, most);
        if (!found) return {};
        series.push_back(*std::move(found));
    }
    // What round-off may take of the accuracy.
    const auto isRoundedOff = [&](const Errors& errors) {
        return std::any_of(series.begin(), series.end(), [&](const GainSeries& gain) {
            return errors.others(gain, details.largest) - gain.mismatch > 0.25 * options.accuracy;
        });
    };
    Errors errors(details, options, isSingle);
    if (isRoundedOff(errors)) {
        if (!isSingle && !S.isProduct()) return {};
        if (isSingle) {
            isSingle = false;
            terms = newTerms();
            terms->start();
            errors = Errors(details, options, isSingle);
        }
    }
    double largest = details.largest;
    const int count = sumTerms(*terms, series, errors, options.accuracy, largest, progress);

    std::vector<FullSpectrumResult> results(gains.size());
    for (std::size_t g = 0; g < gains.size(); ++g) {
        FullSpectrumResult& result = results[g];
        result.Y.resize(X.rows(), X.cols());
        parallelRows(X.rows(), [&](Index begin, Index end) {
            for (Index c = 0; c < X.cols(); ++c)
                for (Index i = begin; i < end; ++i)
                    result.Y(i, c) = series[g].atZero * centred(i, c) + terms->sum(g, i, c);
        });
        terms->release(g);
        laplacian.constants.add(centred.means() - laplacian.constants.means(result.Y), result.Y);
        result.dimension = count;
        result.errorEstimate =
            errors.truncation(series[g], count, largest) + errors.others(series[g], largest);
        result.converged = result.errorEstimate <= options.accuracy;
        if (!result.converged) result.errorEstimate *= kNotConverged;
    }
    return results;
}

}  // namespace spectral
