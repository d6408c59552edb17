// Our LDL^T against Eigen's and CHOLMOD's, on W + s D of a mesh and of its midpoint subdivisions:
//   bench_ldlt MESH.ply [SUBDIVISIONS, default 2]
// Numeric factorization without symbolic analysis, and a solve with three right-hand sides,
// in milliseconds: medians of five. s is the lambda of a feature size of 15 % of the diagonal.

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#ifdef SPECTRAL_CHOLMOD
#include <Eigen/CholmodSupport>
#endif

#include "core/laplacian/laplacian.h"
#include "core/ldlt/shifted_ldlt.h"
#include "core/mesh/measures.h"
#include "core/support/frequency.h"
#include "core/support/threads.h"
#include "support/evaluation.h"
#include "support/ply.h"

using namespace spectral;

namespace {

double medianMilliseconds(const std::function<void()>& work) {
    constexpr int kRuns = 5;
    std::vector<double> milliseconds;
    for (int run = 0; run < kRuns; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::milli> took =
            std::chrono::steady_clock::now() - start;
        milliseconds.push_back(took.count());
    }
    std::sort(milliseconds.begin(), milliseconds.end());
    return milliseconds[kRuns / 2];
}

testing::Mesh subdivided(const testing::Mesh& mesh) {
    std::map<std::pair<int, int>, int> middles;
    std::vector<Eigen::RowVector3d> added;
    const auto middle = [&](int i, int j) {
        const auto [place, isNew] = middles.try_emplace(
            std::minmax(i, j), static_cast<int>(mesh.V.rows()) + static_cast<int>(added.size()));
        if (isNew) added.emplace_back(0.5 * (mesh.V.row(i) + mesh.V.row(j)));
        return place->second;
    };
    testing::Mesh fine;
    fine.F.resize(4 * mesh.F.rows(), 3);
    for (Index t = 0; t < mesh.F.rows(); ++t) {
        const int a = mesh.F(t, 0), b = mesh.F(t, 1), c = mesh.F(t, 2);
        const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        fine.F.middleRows(4 * t, 4) << a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca;
    }
    fine.V.resize(mesh.V.rows() + static_cast<Index>(added.size()), 3);
    fine.V.topRows(mesh.V.rows()) = mesh.V;
    for (std::size_t i = 0; i < added.size(); ++i)
        fine.V.row(mesh.V.rows() + static_cast<Index>(i)) = added[i];
    return fine;
}

void printRow(const char* name, double factorize, double solve) {
    std::printf("  %-34s%12.1f%12.2f\n", name, factorize, solve);
    std::fflush(stdout);
}

void measureOurs(const char* name, int threads, const Laplacian& A, double shift,
                 const Eigen::MatrixXd& B) {
    const ThreadTeam team(threads);
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, shift);
    printRow(name, medianMilliseconds([&] { ldlt.factorizeDefinite(A.W, A.D, shift); }),
             medianMilliseconds([&] { ldlt.solve(B); }));
}

template <class Solver>
void measure(const char* name, const SparseMatrix& A, const Eigen::MatrixXd& B) {
    Solver solver;
    solver.analyzePattern(A);
    Eigen::MatrixXd X;
    const double factorize = medianMilliseconds([&] { solver.factorize(A); });
    printRow(name, factorize, medianMilliseconds([&] { X = solver.solve(B); }));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_ldlt MESH.ply [SUBDIVISIONS]\n");
        return 2;
    }
    testing::Mesh mesh = testing::readPly(argv[1]);
    const int subdivisions = argc > 2 ? std::atoi(argv[2]) : 2;
    for (int level = 0; level <= subdivisions; ++level) {
        if (level > 0) mesh = subdivided(mesh);
        const Laplacian A = testing::cotangentLaplacian(mesh.V, mesh.F);
        const double omega = cutoffFrequency(0.15 * boundingBoxDiagonal(mesh.V));
        SparseMatrix shifted = A.W;
        shifted.diagonal() += omega * omega * A.D;
        const Eigen::MatrixXd B = mesh.V;
        std::printf("%ld vertices%26s%12s\n", static_cast<long>(B.rows()), "factorize", "solve");
        measureOurs("ours, one thread", 1, A, omega * omega, B);
        if (threadCount() > 1) measureOurs("ours, all threads", threadCount(), A, omega * omega, B);
        measure<Eigen::SimplicialLDLT<SparseMatrix>>("Eigen SimplicialLDLT", shifted, B);
#ifdef SPECTRAL_CHOLMOD
        measure<Eigen::CholmodSimplicialLDLT<SparseMatrix>>("CHOLMOD simplicial", shifted, B);
        measure<Eigen::CholmodSupernodalLLT<SparseMatrix>>("CHOLMOD supernodal", shifted, B);
#endif
    }
}
