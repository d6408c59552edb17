#include "core/harmonics/spectrum_slicing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "core/support/errors.h"
#include "core/support/threads.h"

namespace spectral {

namespace {

/// Factor by which the upper end is raised while too few eigenvalues are below it. The larger one
/// applies when the last move passed no eigenvalue: those of a large, coarse component lie far
/// below those of small ones.
constexpr double kRaise = 1.25, kRaiseInGap = 4.0;
/// Number of such moves after which something must be wrong.
constexpr int kMaxMoves = 60;

/// Intervals with this many times the wanted number of eigenvalues are divided, unless their
/// relative width is below kMinRelativeWidth: a cluster.
constexpr Index kTooMany = 2;
constexpr double kMinRelativeWidth = 1e-3;

/// Number of eigenvalues below a shift.
struct Count {
    double sigma = 0.0;
    Index below = 0;
};

/// Adds the numbers of eigenvalues below the given shifts to `counts`, and sorts these.
void countAt(const std::vector<double>& sigmas, const Laplacian& laplacian,
             std::vector<ShiftedLdlt>& factors, const Progress& progress,
             std::vector<Count>& counts) {
    const std::size_t known = counts.size();
    counts.resize(known + sigmas.size());
    runTasks(
        static_cast<Index>(sigmas.size()),
        [&](Index task, int thread, const StopPoint& stopPoint) {
            const auto i = static_cast<std::size_t>(task);
            ShiftedLdlt& factor = factors[static_cast<std::size_t>(thread)];
            factor.factorize(laplacian.W, laplacian.D, sigmas[i], stopPoint);
            counts[known + i] = {factor.shift(), factor.eigenvaluesBelow()};
        },
        progress, "counting the harmonics");
    std::sort(counts.begin(), counts.end(),
              [](const Count& a, const Count& b) { return a.sigma < b.sigma; });
}

/// Initial cuts by Weyl's law: lambda_i ~ 4 pi i / area.
std::vector<double> firstCuts(Index first, Index k, Index width, double area) {
    std::vector<double> sigmas;
    for (Index i = first + width; i < k + width; i += width)
        sigmas.push_back(4.0 * kPi / area * static_cast<double>(std::min(i, k)));
    return sigmas;
}

/// Cuts that divide the intervals with too many eigenvalues, assumed evenly spaced.
std::vector<double> moreCuts(const std::vector<Count>& counts, Index width) {
    std::vector<double> sigmas;
    for (std::size_t i = 1; i < counts.size(); ++i) {
        const Count &a = counts[i - 1], &b = counts[i];
        const Index parts = (b.below - a.below) / width;
        if (parts < kTooMany || b.sigma - a.sigma <= kMinRelativeWidth * b.sigma) continue;
        for (Index j = 1; j < parts; ++j)
            sigmas.push_back(a.sigma + (b.sigma - a.sigma) * static_cast<double>(j) /
                                           static_cast<double>(parts));
    }
    return sigmas;
}

/// Drops the cuts beyond the first one with k eigenvalues below it.
void dropBeyond(Index k, std::vector<Count>& counts) {
    while (counts[counts.size() - 2].below >= k) counts.pop_back();
}

}  // namespace

std::vector<SpectralInterval> sliceSpectrum(const Laplacian& laplacian, Index k, Index width,
                                            std::vector<ShiftedLdlt>& factors,
                                            const Progress& progress) {
    const Index first = laplacian.constants.count();
    std::vector<Count> counts{{0.0, first}};
    double done = 0.0;  // each round takes half of the rest: their number is unknown
    const auto count = [&](const std::vector<double>& sigmas) {
        const double half = 0.5 * (1.0 + done);
        countAt(sigmas, laplacian, factors, progress.part(done, half), counts);
        done = half;
    };
    count(firstCuts(first, k, width, laplacian.D.sum()));
    for (int move = 0; counts.back().below < k; ++move) {
        if (move == kMaxMoves)
            throw SolverFailure(ErrorCode::BasisIncomplete,
                                "no shift above harmonic " + std::to_string(k) + " was found");
        const bool isGap = counts.back().below == counts[counts.size() - 2].below;
        count({(isGap ? kRaiseInGap : kRaise) * counts.back().sigma});
    }
    dropBeyond(k, counts);
    for (std::vector<double> cuts = moreCuts(counts, width); !cuts.empty();
         cuts = moreCuts(counts, width)) {
        count(cuts);
        dropBeyond(k, counts);
    }

    // Merge neighbouring intervals with few eigenvalues.
    std::vector<SpectralInterval> intervals;
    for (std::size_t i = 1; i < counts.size(); ++i) {
        const Count &a = counts[i - 1], &b = counts[i];
        const Index inside = b.below - a.below;
        if (inside == 0) continue;  // leave out gaps: the shift must be close to the eigenvalues
        if (!intervals.empty() && intervals.back().count + inside <= width) {
            intervals.back().to = b.sigma;
            intervals.back().count += inside;
        } else {
            intervals.push_back({a.sigma, b.sigma, a.below, inside});
        }
    }
    return intervals;
}

}  // namespace spectral
