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
// Before that, the memory of the band filter alone, as the plugin applies it.
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
#include "support/memory.h"
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

constexpr double kMegabyte = 1024.0 * 1024.0;

/// Of each of the two, by turns.
constexpr int kRepetitions = 3;

struct Filter {
    const char* name;
    double featureSize;  // in diagonals
    TransferFunctionOptions options;
};

Filter lowPass() { return {"low-pass 15 %", 0.15, {}}; }

Filter bandFilter() {
    TransferFunctionOptions band;
    band.type = FilterType::BandPass;
    band.stopGain = 1.0;
    band.passGain = 2.5;
    return {"band 2.5x at 20 %", 0.20, band};
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

/// A filter in steps, of a mesh.
struct Problem {
    Problem(const testing::Mesh& mesh, const Filter& filter, int steps)
        : surface(surfaceOf(mesh.V, mesh.F)),
          diagonal(boundingBoxDiagonal(surface.X)),
          laplacians(surface, LaplacianKind::IntrinsicDelaunay, BasisUpdate::Conformal),
          components(connectedComponents(surface.F, surface.X.rows())),
          F(filter.options, cutoffFrequency(filter.featureSize * diagonal)),
          power(1.0 / steps),
          gain(fractionalPower(F, power)) {}

    /// The gain of a step beyond the basis.
    double restOf(const HarmonicBasis& basis, const Laplacian& A) const {
        const double last = std::sqrt(basis.lambda[basis.size() - 1]);
        return std::pow(meanGain(F, last, std::sqrt(largestEigenvalue(A))), power);
    }

    Surface surface;
    double diagonal;
    mutable LaplacianBuilder laplacians;
    Components components;
    TransferFunction F;
    double power;
    Gain gain;
};

/// Prints the memory of a filter alone, with an update where the gate lets it.
void measureMemory(const testing::Mesh& mesh, Index k, int steps, const Filter& filter) {
    const Problem problem(mesh, filter, steps);
    Laplacian A = problem.laplacians.input();
    const double before = testing::peakMegabytes();
    std::vector<ShiftedLdlt> factors;
    ShiftedCholesky work;
    ConstantModes constants(problem.components, A.D);
    HarmonicBasis basis = truncatedBasis(A, constants, k, work, factors);
    const double size = static_cast<double>(basis.Phi.size() * sizeof(double)) / kMegabyte;
    Vertices X = applyInBasis(basis, A.D, constants, problem.gain, problem.restOf(basis, A),
                              problem.surface.X);
    int updates = 0;
    for (int step = 2; step <= steps; ++step) {
        A = problem.laplacians(X);
        constants = ConstantModes(problem.components, A.D);
        if (updateBasis(A, constants, k, UpdateGate(), basis, factors).accepted) {
            ++updates;
            X = applyInLeakingBasis(basis, A.D, constants, problem.gain, problem.restOf(basis, A),
                                    X, factors.front());
        } else {
            basis = truncatedBasis(A, constants, k, work, factors);
            X = applyInBasis(basis, A.D, constants, problem.gain, problem.restOf(basis, A), X);
        }
    }
    std::printf("%s, %d steps, %d updates: %.0f MB above the start, of them the basis %.0f MB\n",
                filter.name, steps, updates, testing::peakMegabytes() - before, size);
}

void run(const testing::Mesh& mesh, Index k, int steps, const Filter& filter) {
    const Problem problem(mesh, filter, steps);
    std::vector<ShiftedLdlt> factors, factorsFromNothing;

    std::printf("%s, %d steps\n", filter.name, steps);
    ShiftedCholesky work;
    Laplacian A = problem.laplacians.input();
    ConstantModes constants(problem.components, A.D);
    HarmonicBasis basis = truncatedBasis(A, constants, k, work, factorsFromNothing);
    Vertices X = applyInBasis(basis, A.D, constants, problem.gain, problem.restOf(basis, A),
                              problem.surface.X),
             Y = X;
    for (int step = 2; step <= steps; ++step) {
        A = problem.laplacians(X);
        constants = ConstantModes(problem.components, A.D);
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
        const double rest = problem.restOf(basis, A);
        Vertices next;
        for (int i = 0; i < kRepetitions; ++i) {
            times.plain.measure(
                [&] { next = applyInBasis(basis, A.D, constants, problem.gain, rest, X); });
            if (accepted)
                times.corrected.measure([&] {
                    next = applyInLeakingBasis(basis, A.D, constants, problem.gain, rest, X,
                                               factors.front());
                });
        }
        X = next;

        A = problem.laplacians(Y);
        constants = ConstantModes(problem.components, A.D);
        const HarmonicBasis exact = truncatedBasis(A, constants, k, work);
        Y = applyInBasis(exact, A.D, constants, problem.gain, problem.restOf(exact, A), Y);
        const double update =
            times.update.least() + (accepted ? times.corrected.least() - times.plain.least() : 0.0);
        const double fromNothing = times.fromNothing.least();
        std::printf(
            "  step %2d: %s %.2f s, from nothing %.2f s, ratio %.2f; eigenvalues %.1e, mean "
            "%.1e; residuals %.1e, mean %.1e; vertices %.1e diagonals\n",
            step, accepted ? "update" : "refused", update, fromNothing, fromNothing / update,
            largest, mean, basis.residuals.maxCoeff(), basis.residuals.mean(),
            (X - Y).rowwise().norm().maxCoeff() / problem.diagonal);
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
        const Index k = argc > 2 ? std::atoi(argv[2]) : 300;
        const int steps = argc > 3 ? std::atoi(argv[3]) : 10;
        measureMemory(mesh, k, steps, bandFilter());  // first: what follows needs more
        for (const Filter& filter : {lowPass(), bandFilter()}) run(mesh, k, steps, filter);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_update: %s\n", error.what());
        return 1;
    }
}
