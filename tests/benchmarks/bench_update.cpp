// The update of a basis against the basis from nothing, step by step of a truncated filter.
//
// usage: bench_update MESH.ply [HARMONICS [STEPS]]
//
// Two filters, each in STEPS (10) fractional steps with conformal update: a Gaussian low-pass at 15
// % of the diagonal, and a band of gain 2.5 at 20 %. In every step the basis of HARMONICS (300) is
// made of the one before, and computed from nothing for the same Laplacian. What is beyond it has
// the filter's mean gain there, so that the gain jumps at the cut. A second shape is filtered with
// a basis from nothing in every step: `vertices` is how far the two are apart.
//
// Times are the least of three, of the update and of the basis from nothing by turns. Neither
// includes the symbolic analysis, which a filter makes once for all steps; that of an update
// includes what the correction for its leaks costs, that of applyInLeakingBasis beside
// applyInBasis.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <vector>

#include "core/basis_update.h"
#include "core/components.h"
#include "core/laplacian_builder.h"
#include "core/leak_correction.h"
#include "core/measures.h"
#include "core/surface.h"
#include "support/ply.h"

namespace {

using namespace spectral;

double seconds() {
    using Clock = std::chrono::steady_clock;
    return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// The least time of those measured: what else the machine does only adds to it.
class LeastTime {
  public:
    template <class Work>
    void measure(const Work& work) {
        const double start = seconds();
        work();
        least_ = std::min(least_, seconds() - start);
    }
    double least() const { return least_; }

  private:
    double least_ = std::numeric_limits<double>::infinity();
};

struct Times {
    LeastTime update, corrected, plain, fromNothing;
};

/// Of each of the two, by turns.
constexpr int kRepetitions = 3;

struct Filter {
    const char* name;
    double featureSize;  // in diagonals
    TransferFunctionOptions options;
};

std::vector<Filter> filters() {
    TransferFunctionOptions band;
    band.type = FilterType::BandPass;
    band.stopGain = 1.0;
    band.passGain = 2.5;
    return {{"low-pass 15 %", 0.15, {}}, {"band 2.5x at 20 %", 0.20, band}};
}

/// Largest and mean relative difference of eigenvalues that are not 0.
void compare(const HarmonicBasis& basis, const HarmonicBasis& anew, Index constants,
             double& largest, double& mean) {
    const Index k = std::min(basis.size(), anew.size()) - constants;
    const Eigen::ArrayXd error =
        (basis.lambda.segment(constants, k).array() / anew.lambda.segment(constants, k).array() -
         1.0)
            .abs();
    largest = error.maxCoeff();
    mean = error.mean();
}

void run(const testing::Mesh& mesh, Index k, int steps, const Filter& filter) {
    const Surface surface = surfaceOf(mesh.V, mesh.F);
    const double diagonal = boundingBoxDiagonal(surface.X);
    const LaplacianBuilder laplacians(surface, LaplacianKind::IntrinsicDelaunay,
                                      BasisUpdate::Conformal);
    const Components components = connectedComponents(surface.F, surface.X.rows());
    const TransferFunction F(filter.options, cutoffFrequency(filter.featureSize * diagonal));
    const Gain gain = fractionalPower(F, 1.0 / steps);
    std::vector<ShiftedLdlt> factors, factorsFromNothing;
    const auto restOf = [&](const HarmonicBasis& basis, const Laplacian& A) {
        const double last = std::sqrt(basis.lambda[basis.size() - 1]);
        return std::pow(meanGain(F, last, std::sqrt(largestEigenvalue(A))), 1.0 / steps);
    };

    std::printf("%s, %d steps\n", filter.name, steps);
    ShiftedCholesky work;
    Laplacian A = laplacians.input();
    ConstantModes constants(components, A.D);
    HarmonicBasis basis = truncatedBasis(A, constants, k, work, factorsFromNothing);
    Vertices X = applyInBasis(basis, A.D, constants, gain, restOf(basis, A), surface.X), Y = X;
    for (int step = 2; step <= steps; ++step) {
        A = laplacians(X);
        constants = ConstantModes(components, A.D);
        Times times;
        const HarmonicBasis previous = basis;
        HarmonicBasis anew;
        bool accepted = false;
        for (int i = 0; i < kRepetitions; ++i) {
            basis = previous;
            times.update.measure([&] {
                accepted = updateBasis(A, constants, k, UpdateGate(), basis, factors).accepted;
            });
            times.fromNothing.measure(
                [&] { anew = truncatedBasis(A, constants, k, work, factorsFromNothing); });
        }
        if (!accepted) basis = anew;
        double largest, mean;
        compare(basis, anew, constants.count(), largest, mean);
        const double rest = restOf(basis, A);
        Vertices next;
        for (int i = 0; i < kRepetitions; ++i) {
            times.plain.measure([&] { next = applyInBasis(basis, A.D, constants, gain, rest, X); });
            if (accepted)
                times.corrected.measure([&] {
                    next =
                        applyInLeakingBasis(basis, A.D, constants, gain, rest, X, factors.front());
                });
        }
        X = next;

        A = laplacians(Y);
        constants = ConstantModes(components, A.D);
        const HarmonicBasis exact = truncatedBasis(A, constants, k, work);
        Y = applyInBasis(exact, A.D, constants, gain, restOf(exact, A), Y);
        const double update =
            times.update.least() + (accepted ? times.corrected.least() - times.plain.least() : 0.0);
        const double fromNothing = times.fromNothing.least();
        std::printf(
            "  step %2d: %s %.2f s, from nothing %.2f s, ratio %.2f; eigenvalues %.1e, mean "
            "%.1e; residuals %.1e, mean %.1e; vertices %.1e diagonals\n",
            step, accepted ? "update" : "refused", update, fromNothing, fromNothing / update,
            largest, mean, basis.residuals.maxCoeff(), basis.residuals.mean(),
            (X - Y).rowwise().norm().maxCoeff() / diagonal);
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argc > 4) {
        std::fprintf(stderr, "usage: bench_update MESH.ply [HARMONICS [STEPS]]\n");
        return 2;
    }
    try {
        const testing::Mesh mesh = testing::readPly(argv[1]);
        for (const Filter& filter : filters())
            run(mesh, argc > 2 ? std::atoi(argv[2]) : 300, argc > 3 ? std::atoi(argv[3]) : 10,
                filter);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_update: %s\n", error.what());
        return 1;
    }
}
