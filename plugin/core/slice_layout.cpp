#include "slice_layout.h"

#include <algorithm>
#include <limits>

namespace spectral {

namespace {

/// What a slice costs beside a solve for one vector: its factorization; and to make one of its
/// vectors orthogonal to the others, divided by their number.
constexpr double kFactorization = 65.0, kOrthogonalization = 1.0 / 60.0;

/// Vectors from one possible end of a slice to the next.
constexpr Index kGrain = 4;

/// In solves for one vector.
double cost(const SliceOfVectors& vectors) {
    const int solves = iterations(vectors.slice);
    const auto width = static_cast<double>(vectors.count);
    return kFactorization + width * (solves + (solves - 1) * kOrthogonalization * width);
}

}  // namespace

std::vector<SliceOfVectors> layOutSlices(const Eigen::VectorXd& quotient, double bound,
                                         double damping) {
    const auto between = [&](Index begin, Index end) {
        return SliceOfVectors{
            begin, end - begin, {quotient[begin], quotient[end - 1], bound, damping}};
    };
    std::vector<Index> ends{0};  // where a slice may end
    while (ends.back() < quotient.size())
        ends.push_back(std::min(ends.back() + kGrain, quotient.size()));
    // The least cost of all slices up to an end, and where the last of them then begins.
    std::vector<double> least(ends.size(), std::numeric_limits<double>::infinity());
    std::vector<std::size_t> last(ends.size(), 0);
    least[0] = 0.0;
    for (std::size_t end = 1; end < ends.size(); ++end)
        for (std::size_t begin = 0; begin < end; ++begin) {
            const double all = least[begin] + cost(between(ends[begin], ends[end]));
            if (all >= least[end]) continue;
            least[end] = all;
            last[end] = begin;
        }
    std::vector<SliceOfVectors> slices;
    for (std::size_t end = ends.size() - 1; end > 0; end = last[end])
        slices.push_back(between(ends[last[end]], ends[end]));
    std::sort(slices.begin(), slices.end(), [](const SliceOfVectors& a, const SliceOfVectors& b) {
        const double costA = cost(a), costB = cost(b);
        return costA != costB ? costA > costB : a.first < b.first;
    });
    return slices;
}

}  // namespace spectral
