// The fractional flow: how fast its step schemes converge, the errors of both with K steps against
// a fine limit.
//   bench_steps MESH.ply...
// Errors are the largest of any vertex, in diagonals of the bounding box. Takes minutes on meshes
// of 40,000 vertices and more.

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <vector>

#include "core/filter/automatic_steps.h"
#include "core/filter/fractional_filter.h"
#include "core/filter/fractional_steps.h"
#include "core/laplacian/interior.h"
#include "core/mesh/measures.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
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

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: %s MESH.ply...\n", argv[0]);
        return 2;
    }
    for (int i = 1; i < argc; ++i) printConvergence(argv[i]);
    return EXIT_SUCCESS;
}
