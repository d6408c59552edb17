// Spectral Equalizer on a mesh: what a preview costs, and what the logged accuracy is worth:
//   bench_equalizer MESH.ply [SETTINGS, default 0]
// Times are of the processor. With SETTINGS, as many random ones, the same for every mesh, are
// compared with runs to a tenth of the tolerance; those where these do not converge, or take no
// more steps, are left out.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/contract/filter.h"
#include "core/filter/fractional_filter.h"
#include "core/laplacian/laplacian.h"
#include "core/mesh/measures.h"
#include "core/support/errors.h"
#include "core/transfer/equalizer.h"
#include "support/ply.h"

using namespace spectral;

namespace {

const char* const kGains[] = {"gain_32x", "gain_16x", "gain_8x", "gain_4x", "gain_2x", "gain_1x"};

template <class Work>
double secondsOf(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void timePreviews(const FilterInput& input) {
    const Filter& filter = filterNamed("apply_coord_spectral_equalizer");
    std::shared_ptr<void> kept;
    Vertices draft, sum;
    std::printf("%ld vertices, processor seconds:\n", static_cast<long>(input.V.rows()));
    for (const char* const gain : {"gain_8x", "gain_4x", "gain_2x", "gain_1x"}) {
        const Values given{{gain, 2.0}};
        Values accurate = given;
        accurate["accurate"] = true;
        Vertices exact;
        const double before = secondsOf([&] { draft = apply(filter, input, given).V; });
        const double after = secondsOf([&] { sum = preview(filter, input, given, kept).V; });
        const double again = secondsOf([&] { preview(filter, input, given, kept); });
        exact = apply(filter, input, accurate).V;
        const double moved = (exact - input.V).norm();
        std::printf(
            "  %s x 2: a run %.2f, error %.3f of the displacement; preview %.2f, then %.3f, error "
            "%.3f\n",
            gain, before, (draft - exact).norm() / moved, after, again,
            (sum - exact).norm() / moved);
        std::fflush(stdout);
    }
}

/// The distance that is exceeded on at most a thousandth of the area, as the estimate ignores it.
double errorOf(const Vertices& V, const Vertices& exact, const Eigen::VectorXd& area) {
    const Eigen::VectorXd length = (V - exact).rowwise().norm();
    std::vector<Index> order(static_cast<std::size_t>(V.rows()));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
    std::sort(order.begin(), order.end(), [&](Index i, Index j) { return length[i] > length[j]; });
    double left = 1e-3 * area.sum();
    for (const Index i : order)
        if ((left -= area[i]) < 0.0) return length[i];
    return 0.0;
}

/// A random setting of the sliders: a tenth of them at 0, two fifths at 1.
Equalizer randomEqualizer(const MeshLengths& mesh, std::mt19937& random) {
    std::uniform_real_distribution<double> octave(-2.0, 2.0), share(0.0, 1.0);
    std::vector<double> gains;
    for (std::size_t k = 0; k < std::size(kGains); ++k) {
        const double gain = std::exp2(octave(random)), kind = share(random);
        gains.push_back(kind < 0.1 ? 0.0 : kind < 0.5 ? 1.0 : gain);
    }
    return octaveEqualizer(defaultSmallestSize(mesh.meanEdge, mesh.surfaceDiagonal), gains);
}

/// How the estimated errors of accurate runs and drafts compare with the true ones.
void compareErrors(const FilterInput& input, int settings) {
    const MeshLengths mesh = lengthsOf(input.V, input.F);
    const char* const names[] = {"draft", "accurate"};
    std::mt19937 random(1);
    std::vector<double> ratios[2];
    for (int i = 0; i < settings; ++i) {
        const Equalizer equalizer = randomEqualizer(mesh, random);
        FilterOptions options;
        options.transferFunction.type = FilterType::Custom;
        options.transferFunction.custom = equalizer;
        options.featureSize = equalizer.middleSize();
        try {
            options.tolerance = 0.1 * defaultTolerance(mesh);
            const FilterResult exact = fractionalFilter(input.V, input.F, options);
            if (!exact.toleranceReached) {
                std::printf("setting %d: the reference did not converge\n", i);
                continue;
            }
            const Eigen::VectorXd area = lumpedMass(exact.V, input.F);
            options.tolerance = defaultTolerance(mesh);
            for (const bool isAccurate : {false, true}) {
                options.maxSteps = isAccurate ? FilterOptions().maxSteps : 2;
                const FilterResult result = fractionalFilter(input.V, input.F, options);
                if (exact.passes <= result.passes) {
                    std::printf("setting %d: the reference took no more steps\n", i);
                    continue;
                }
                const double error = errorOf(result.V, exact.V, area);
                if (error > 0.0) ratios[isAccurate].push_back(result.stepError / error);
                std::printf("setting %d, %s: estimate %.3g, true %.3g, ratio %.2f\n", i,
                            names[isAccurate], result.stepError, error, result.stepError / error);
                std::fflush(stdout);
            }
        } catch (const Error& failure) {
            std::printf("setting %d failed: %s\n", i, failure.what());
        }
    }
    for (const bool isAccurate : {false, true}) {
        const std::vector<double>& all = ratios[isAccurate];
        const auto good =
            std::count_if(all.begin(), all.end(), [](double r) { return r >= 0.5 && r <= 2.0; });
        std::printf("%s: %ld of %zu within a factor of two\n", names[isAccurate],
                    static_cast<long>(good), all.size());
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_equalizer MESH.ply [SETTINGS]\n");
        return 2;
    }
    const testing::Mesh mesh = testing::readPly(argv[1]);
    const FilterInput input{mesh.V, mesh.F};
    const int settings = argc > 2 ? std::atoi(argv[2]) : 0;
    if (settings == 0)
        timePreviews(input);
    else
        compareErrors(input, settings);
}
