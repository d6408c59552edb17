// The fractional flow: how fast its step schemes converge, and what a truncated spectrum gains
// where later steps need no basis.
//   bench_steps convergence MESH.ply...   errors of both schemes with K steps against a fine limit
//   bench_steps truncated MESH.ply...     ten truncated steps against ten with a basis each
// Errors are the largest of any vertex, in diagonals of the bounding box. All take minutes on
// meshes of 40,000 vertices and more.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "core/filter/automatic_steps.h"
#include "core/filter/fractional_filter.h"
#include "core/filter/fractional_steps.h"
#include "core/laplacian/interior.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/support/threads.h"
#include "core/transfer/transfer_function.h"
#include "support/ply.h"

using namespace spectral;

namespace {

struct Case {
    const char* name;
    FilterType type;
    double featureSize;  // in diagonals
    BasisUpdate update;
};

constexpr Case kCases[] = {
    {"low-pass 15 %, full", FilterType::LowPass, 0.15, BasisUpdate::Full},
    {"low-pass 15 %, conformal", FilterType::LowPass, 0.15, BasisUpdate::Conformal},
    {"band 2.5x at 20 %, full", FilterType::BandPass, 0.2, BasisUpdate::Full},
    {"band 2.5x at 20 %, conformal", FilterType::BandPass, 0.2, BasisUpdate::Conformal},
};

FilterOptions optionsOf(const Case& c, double diagonal) {
    FilterOptions options;
    options.transferFunction.type = c.type;
    if (c.type == FilterType::BandPass) {
        options.transferFunction.stopGain = 1.0;
        options.transferFunction.passGain = 2.5;
    }
    options.featureSize = c.featureSize * diagonal;
    options.basisUpdate = c.update;
    return options;
}

/// The two step schemes of the core, without the rest of the filter.
class Flow {
  public:
    Flow(const Surface& surface, const FilterOptions& options)
        : surface_(surface),
          interior_(surface.F, connectedComponents(surface.F, surface.X.rows()), Boundary::Free),
          F_(options.transferFunction, 2.0 * kPi / options.featureSize),
          laplacians_(surface, interior_.surfaceComponents(), options.laplacian,
                      options.basisUpdate) {}

    Vertices paper(int K) const {
        StepEvaluator evaluate(evaluation_, interior_, F_);
        return fixedSteps(laplacians_, evaluate, surface_.X, K, {}).X;
    }

    Vertices midpoint(int K) const {
        StepEvaluator evaluate(evaluation_, interior_, F_);
        return midpointSteps(laplacians_, evaluate, surface_.X, K, 16 * K, {}).X;
    }

  private:
    const Surface& surface_;
    EvaluationOptions evaluation_;
    Interior interior_;
    TransferFunction F_;
    mutable LaplacianBuilder laplacians_;
};

double largestDifference(const Vertices& A, const Vertices& B) {
    return (A - B).rowwise().norm().maxCoeff();
}

void printConvergence(const char* file) {
    const testing::Mesh mesh = testing::readPly(file);
    const Surface surface = surfaceOf(mesh.V, mesh.F);
    const double diagonal = boundingBoxDiagonal(surface.X);
    std::printf("\n%s\n| filter | scheme |", file);
    constexpr int kMost = 32;
    for (int K = 1; K <= kMost; K *= 2) std::printf(" K = %d |", K);
    std::printf("\n");
    for (const Case& c : kCases) {
        const Flow flow(surface, optionsOf(c, diagonal));
        // Richardson's extrapolation: its error is far below that of any column.
        const Vertices finest = flow.midpoint(4 * kMost);
        const Vertices limit = finest + (finest - flow.midpoint(2 * kMost)) / 3.0;
        const auto row = [&](const char* scheme, const std::function<Vertices(int)>& steps) {
            std::printf("| %s | %s |", c.name, scheme);
            for (int K = 1; K <= kMost; K *= 2)
                std::printf(" %.1e |", largestDifference(steps(K), limit) / diagonal);
            std::printf("\n");
            std::fflush(stdout);
        };
        row("paper's", [&](int K) { return flow.paper(K); });
        row("midpoint", [&](int K) { return flow.midpoint(K); });
    }
}

void printTruncated(const char* file) {
    const testing::Mesh mesh = testing::readPly(file);
    const Surface surface = surfaceOf(mesh.V, mesh.F);
    const Interior interior(surface.F, connectedComponents(surface.F, surface.X.rows()),
                            Boundary::Free);
    const double diagonal = boundingBoxDiagonal(surface.X);
    constexpr int kSteps = 10;
    const ThreadTeam team;
    for (const Case& c : kCases) {
        FilterOptions options = optionsOf(c, diagonal);
        options.evaluation.spectrum = Spectrum::Truncated;
        const TransferFunction F(options.transferFunction, 2.0 * kPi / options.featureSize);
        LaplacianBuilder laplacians(surface, interior.surfaceComponents(), options.laplacian,
                                    options.basisUpdate);
        const auto step = [&](StepEvaluator& evaluate, Vertices& X) {
            const auto start = std::chrono::steady_clock::now();
            laplacians.update(X);
            X = evaluate(laplacians.current(), X, 1.0 / kSteps, {}).Y.front();
            return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        };
        StepEvaluator evaluate(options.evaluation, interior, F);
        Vertices X = surface.X, withBases = surface.X;
        double seconds = 0.0, secondsWithBases = 0.0;
        for (int i = 0; i < kSteps; ++i) {  // in turns: a machine's speed varies
            seconds += step(evaluate, X);
            StepEvaluator fresh(options.evaluation, interior, F);
            secondsWithBases += step(fresh, withBases);
        }
        std::printf("| %s | %s | %.1f | %.1f | %.2f | %.1e | %d |\n", file, c.name, seconds,
                    secondsWithBases, secondsWithBases / seconds,
                    largestDifference(X, withBases) / diagonal, evaluate.computedBases());
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string table = argc > 2 ? argv[1] : "";
    if (table != "convergence" && table != "truncated") {
        std::fprintf(stderr, "usage: %s convergence|truncated MESH.ply...\n", argv[0]);
        return 2;
    }
    if (table == "truncated")
        std::printf(
            "| mesh | filter | seconds | with a basis in every step | ratio | largest distance | "
            "bases |\n");
    for (int i = 2; i < argc; ++i)
        (table == "truncated" ? printTruncated : printConvergence)(argv[i]);
    return EXIT_SUCCESS;
}
