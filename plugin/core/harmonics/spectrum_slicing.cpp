#include "core/harmonics/spectrum_slicing.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "core/laplacian/constant_modes.h"
#include "core/support/errors.h"
#include "core/support/parallel_tasks.h"

namespace spectral {

namespace {

/// The last cut aims at so many eigenvalues more than asked; once it has enough, so many tries are
/// for at most twice as many. Tries in all, after which something must be wrong.
constexpr Index kMorePairs = 4;
constexpr int kTriesForFew = 6, kMaxTries = 60;

/// Factor by which a try goes farther at least, and where the last one has found no eigenvalue: a
/// large part of few vertices has all of its own far below those of small parts.
constexpr double kFarther = 1.02, kAcrossGap = 4.0;

/// A slice with more than so many times the width wanted is halved, unless it is narrower than this
/// part of its eigenvalues: these are copies of one, or as good as that.
constexpr Index kTooWide = 2;
constexpr double kNarrowest = 1e-3;

/// Eigenvalues below a shift.
struct Count {
    double sigma = 0.0;
    Index below = 0;
};

bool operator<(const Count& a, const Count& b) { return a.sigma < b.sigma; }

class Slicing {
  public:
    Slicing(const Laplacian& laplacian, Index constants, std::vector<ShiftedLdlt>& factors,
            const Progress& progress)
        : laplacian_(laplacian),
          factors_(factors),
          progress_(progress),
          counts_{{0.0, constants}} {}

    std::vector<SpectrumSlice> cut(Index k, Index width) {
        findEnd(k);
        const Index first = counts_.front().below, total = counts_.back().below - first;
        std::vector<double> sigmas;
        for (Index i = 1; i * width < total; ++i) sigmas.push_back(lambdaAt(first + i * width));
        const Count end = counts_.back();
        counts_ = {counts_.front(), end};  // those on the way to the end are anywhere
        while (!sigmas.empty()) {
            countAt(sigmas);
            sigmas = middlesOfWide(kTooWide * width);
        }
        return slices(width);
    }

  private:
    /// By Weyl's law, lambda_N ~ 4 pi N / area, corrected by counts on the way.
    void findEnd(Index k) {
        const double top = weylSlope() * static_cast<double>(k);
        countAt({0.25 * top, top});
        int triesForFew = 0;
        for (int i = 0; i < kMaxTries; ++i) {
            const Count last = counts_.back();
            const bool enough = last.below >= k;
            if (enough && (last.below <= k + 2 * kMorePairs || triesForFew++ == kTriesForFew))
                return;
            const bool inGap = last.below == counts_[counts_.size() - 2].below;
            const double sigma = lambdaAt(k + kMorePairs);
            const double farther = (inGap ? kAcrossGap : kFarther) * last.sigma;
            countAt({enough ? sigma : std::max(sigma, farther)});
            while (counts_[counts_.size() - 2].below >= k) counts_.pop_back();
        }
        throw SolverFailure("no shift beyond harmonic " + std::to_string(k) + " could be found");
    }

    void countAt(const std::vector<double>& sigmas) {
        const double begin = std::exchange(done_, 0.5 * (1.0 + done_));
        std::vector<Count> counts(sigmas.size());
        runInParallel(
            static_cast<Index>(sigmas.size()),
            [&](Index task, int worker, const StopPoint&) {
                ShiftedLdlt& factor = factors_[static_cast<std::size_t>(worker)];
                factor.factorize(laplacian_, sigmas[static_cast<std::size_t>(task)]);
                counts[static_cast<std::size_t>(task)] = {factor.shift(),
                                                          factor.eigenvaluesBelow()};
            },
            progress_.part(begin, done_), "counting the harmonics");
        counts_.insert(counts_.end(), counts.begin(), counts.end());
        std::sort(counts_.begin(), counts_.end());
    }

    /// About the eigenvalue of this index, between the counts that are known.
    double lambdaAt(Index index) const {
        for (std::size_t i = 1; i < counts_.size(); ++i) {
            const Count &a = counts_[i - 1], &b = counts_[i];
            if (b.below > a.below && (index <= b.below || i + 1 == counts_.size()))
                return a.sigma + (b.sigma - a.sigma) * static_cast<double>(index - a.below) /
                                     static_cast<double>(b.below - a.below);
        }
        return weylSlope() * static_cast<double>(index);
    }

    std::vector<double> middlesOfWide(Index widest) const {
        std::vector<double> middles;
        for (std::size_t i = 1; i < counts_.size(); ++i) {
            const Count &a = counts_[i - 1], &b = counts_[i];
            if (b.below - a.below > widest && b.sigma - a.sigma > kNarrowest * b.sigma)
                middles.push_back(0.5 * (a.sigma + b.sigma));
        }
        return middles;
    }

    /// Between the counts; neighbours with few eigenvalues make one.
    std::vector<SpectrumSlice> slices(Index width) const {
        std::vector<SpectrumSlice> slices;
        for (std::size_t i = 1; i < counts_.size(); ++i) {
            const Count &a = counts_[i - 1], &b = counts_[i];
            const Index count = b.below - a.below;
            const bool isFew = slices.empty() || slices.back().count + count <= width;
            if (!slices.empty() && (isFew || count == 0 || slices.back().count == 0)) {
                slices.back().to = b.sigma;
                slices.back().count += count;
            } else {
                slices.push_back({a.sigma, b.sigma, a.below, count});
            }
        }
        return slices;
    }

    double weylSlope() const { return 4.0 * kPi / laplacian_.D.sum(); }

    const Laplacian& laplacian_;
    std::vector<ShiftedLdlt>& factors_;
    const Progress& progress_;
    double done_ = 0.0;          // how many more counts there will be is not known
    std::vector<Count> counts_;  // ascending
};

}  // namespace

std::vector<SpectrumSlice> sliceSpectrum(const Laplacian& laplacian, const ConstantModes& constants,
                                         Index k, Index width, std::vector<ShiftedLdlt>& factors,
                                         const Progress& progress) {
    return Slicing(laplacian, constants.count(), factors, progress).cut(k, width);
}

}  // namespace spectral
