// What a whole filter costs compared with its factorizations and solves alone, and how much faster
// it is on two threads than on one, in one run of the program:
//   bench_dragon MESH.ply [FEATURE_SIZE as part of the diagonal, default 0.15]
// Times are medians of several runs; compare the ratios, in which the machine's speed cancels out.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "core/filter/fractional_filter.h"
#include "core/krylov/pole_selection.h"
#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/mesh/measures.h"
#include "core/support/threads.h"
#include "core/transfer/transfer_function.h"
#include "support/evaluation.h"
#include "support/ply.h"

using namespace spectral;

namespace {

constexpr int kRuns = 9;

double secondsOf(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    return took.count();
}

double medianOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

double medianSeconds(const std::function<void()>& work) {
    std::vector<double> seconds;
    for (int run = 0; run < kRuns; ++run) seconds.push_back(secondsOf(work));
    return medianOf(seconds);
}

/// How many times as fast two threads are as one: the median over pairs of runs.
double speedUpOf(const std::function<void()>& work) {
    std::vector<double> ratios;
    for (int run = 0; run < kRuns; ++run) {
        setThreadCount(1);
        const double one = secondsOf(work);
        setThreadCount(2);
        ratios.push_back(one / secondsOf(work));
    }
    setThreadCount(0);
    return medianOf(ratios);
}

struct Case {
    const char* name;
    FilterType type;
    Response response;
    int steps;
    BasisUpdate update;
};

FilterOptions optionsOf(const Case& c, double featureSize) {
    FilterOptions options;
    options.transferFunction.type = c.type;
    options.transferFunction.response = c.response;
    if (c.type == FilterType::BandPass) {
        options.transferFunction.stopGain = 1.0;
        options.transferFunction.passGain = 2.5;
    }
    options.featureSize = featureSize;
    options.steps = c.steps;
    options.basisUpdate = c.update;
    return options;
}

/// Seconds of the result's factorizations and solves alone, three columns at a time.
double secondsOfWorkAlone(const testing::Mesh& mesh, const FilterResult& result) {
    const Laplacian laplacian = testing::cotangentLaplacian(mesh.V, mesh.F);
    const double shift = result.cutoffFrequency * result.cutoffFrequency;
    const ThreadTeam team;  // as many threads as the filter
    return medianSeconds([&] {
        ShiftedLdlt ldlt;
        for (int i = 0; i < result.factorizations; ++i)
            ldlt.factorizeDefinite(laplacian.W, laplacian.D, shift);
        Eigen::MatrixXd X = mesh.V;
        for (int i = 0; i < result.solves / 3; ++i)
            X = shift * ldlt.solve(laplacian.D.asDiagonal() * X);
    });
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: %s MESH.ply [FEATURE_SIZE as part of the diagonal]\n",
                     argv[0]);
        return 2;
    }
    const testing::Mesh mesh = testing::readPly(argv[1]);
    const double part = argc > 2 ? std::atof(argv[2]) : 0.15;
    const double diagonal = boundingBoxDiagonal(mesh.V);
    std::printf("%s: %ld vertices, feature size %g of the diagonal, accuracy %g\n", argv[1],
                static_cast<long>(mesh.V.rows()), part, EvaluationOptions().accuracy);
    std::printf("%-34s %14s %14s %10s %10s %8s %6s %12s\n", "filter", "factorizations",
                "solves/coord.", "error", "filter s", "alone s", "ratio", "two threads");

    const Case cases[] = {
        {"gaussian low-pass, K = 1", FilterType::LowPass, Response::Gaussian, 1, BasisUpdate::None},
        {"butterworth low-pass, K = 1", FilterType::LowPass, Response::Butterworth, 1,
         BasisUpdate::None},
        {"gaussian band boost, K = 1", FilterType::BandPass, Response::Gaussian, 1,
         BasisUpdate::None},
        {"gaussian low-pass, conformal K = 10", FilterType::LowPass, Response::Gaussian, 10,
         BasisUpdate::Conformal},
        {"gaussian low-pass, full K = 10", FilterType::LowPass, Response::Gaussian, 10,
         BasisUpdate::Full},
        {"gaussian band boost, full K = 10", FilterType::BandPass, Response::Gaussian, 10,
         BasisUpdate::Full},
    };
    for (const Case& c : cases) {
        const FilterOptions options = optionsOf(c, part * diagonal);
        FilterResult result;
        const auto filter = [&] { result = fractionalFilter(mesh.V, mesh.F, options); };
        const double whole = medianSeconds(filter), speedUp = speedUpOf(filter);
        const double alone = secondsOfWorkAlone(mesh, result);
        std::printf("%-34s %14d %14d %10.1e %10.3f %8.3f %6.2f %12.2f\n", c.name,
                    result.factorizations, result.solves / 3, result.errorEstimate, whole, alone,
                    whole / alone, speedUp);
    }
    return EXIT_SUCCESS;
}
