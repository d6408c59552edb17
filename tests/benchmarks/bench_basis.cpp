// The C++ part of bench_basis.py, which runs it: bases of manifold harmonics of a mesh.
//   bench_basis matrices MESH.ply FOLDER    W and D of the cotangent Laplacian, for every program
//   bench_basis slices MESH.ply FOLDER K    our basis (core/harmonics/truncated_basis.h)
//   bench_basis spectra MESH.ply FOLDER K   Spectra, over our Cholesky factorization
// Arrays go to FOLDER as raw binary files, one each; figures go to standard output as JSON.
// Times are those of the basis, including factorizations but not W and D.

#include <Spectra/SymEigsSolver.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/harmonics/truncated_basis.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/ldlt/shifted_ldlt.h"
#include "support/memory.h"
#include "support/ply.h"

using namespace spectral;

namespace {

/// Residual of Spectra's Ritz pairs of the inverse operator. From 1e-6 to 1e-10 it changes neither
/// the time nor the residuals of W phi = lambda D phi: on 40,000 vertices all converge at once.
constexpr double kSpectraTolerance = 1e-8;
constexpr int kSpectraRestarts = 1000;

struct Pairs {
    Eigen::VectorXd lambda;
    Eigen::MatrixXd Phi;
};

/// u -> D^1/2 (W + s D)^-1 D^1/2 u, symmetric, with eigenvalues 1 / (lambda + s).
class InverseOperator {
  public:
    using Scalar = double;

    InverseOperator(const Laplacian& laplacian, double shift) : sqrtD_(laplacian.D.cwiseSqrt()) {
        ldlt_.factorizeDefinite(laplacian.W, laplacian.D, shift);
    }
    Index rows() const { return sqrtD_.size(); }
    Index cols() const { return sqrtD_.size(); }
    void perform_op(const double* in, double* out) const {
        const Eigen::MatrixXd b =
            sqrtD_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(in, rows()));
        Eigen::Map<Eigen::VectorXd>(out, rows()) = sqrtD_.cwiseProduct(ldlt_.solve(b).col(0));
    }

  private:
    Eigen::VectorXd sqrtD_;
    ShiftedLdlt ldlt_;
};

Pairs spectraPairs(const MeshLaplacian& mesh, Index k) {
    // The mean spacing of eigenvalues by Weyl's law, as in basis_problem.py.
    const double shift = 4.0 * kPi / mesh.laplacian.D.sum();
    InverseOperator op(mesh.laplacian, shift);
    Spectra::SymEigsSolver<InverseOperator> solver(op, k, std::min(2 * k, op.rows()));
    solver.init();
    solver.compute(Spectra::SortRule::LargestMagn, kSpectraRestarts, kSpectraTolerance);
    if (solver.info() != Spectra::CompInfo::Successful)
        throw std::runtime_error("Spectra did not converge");
    const Eigen::VectorXd invSqrtD = mesh.laplacian.D.cwiseSqrt().cwiseInverse();
    return {solver.eigenvalues().cwiseInverse().array() - shift,
            invSqrtD.asDiagonal() * solver.eigenvectors()};
}

Pairs slicedPairs(const MeshLaplacian& mesh, Index k) {
    ShiftedLdlt ldlt;
    HarmonicBasis basis = truncatedBasis(mesh.laplacian, k, ldlt);
    return {std::move(basis.lambda), std::move(basis.Phi)};
}

template <typename T>
void write(const std::string& path, const T* data, Index count) {
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(data), count * static_cast<Index>(sizeof(T)));
    if (!out) throw std::runtime_error(path + ": cannot be written");
}

void writeMatrices(const MeshLaplacian& mesh, const std::string& folder) {
    using RowMajorV = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    using RowMajorF = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const RowMajorV V = mesh.surface.X;
    const RowMajorF F = mesh.surface.F;
    SparseMatrix W = mesh.laplacian.W;
    W.makeCompressed();
    write(folder + "/V", V.data(), V.size());
    write(folder + "/F", F.data(), F.size());
    write(folder + "/W.starts", W.outerIndexPtr(), W.outerSize() + 1);
    write(folder + "/W.rows", W.innerIndexPtr(), W.nonZeros());
    write(folder + "/W.values", W.valuePtr(), W.nonZeros());
    write(folder + "/D", mesh.laplacian.D.data(), mesh.laplacian.D.size());
    std::printf("{\"vertices\": %ld, \"components\": %d}\n",
                static_cast<long>(mesh.laplacian.D.size()), mesh.components.count);
}

void measure(const std::function<Pairs()>& compute, const std::string& folder) {
    const double before = testing::peakMegabytes();
    const auto start = std::chrono::steady_clock::now();
    const Pairs pairs = compute();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    const double peak = testing::peakMegabytes() - before;
    write(folder + "/lambda", pairs.lambda.data(), pairs.lambda.size());
    write(folder + "/Phi", pairs.Phi.data(), pairs.Phi.size());
    std::printf("{\"seconds\": %.6f, \"megabytes\": %.1f}\n", took.count(), peak);
}

int run(const std::string& task, const MeshLaplacian& mesh, const std::string& folder, Index k) {
    if (task == "matrices")
        writeMatrices(mesh, folder);
    else if (task == "slices")
        measure([&] { return slicedPairs(mesh, k); }, folder);
    else
        measure([&] { return spectraPairs(mesh, k); }, folder);
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string task = argc > 1 ? argv[1] : "";
    const bool needsK = task == "slices" || task == "spectra";
    if (argc != (needsK ? 5 : 4) || (!needsK && task != "matrices")) {
        std::fprintf(stderr, "usage: %s matrices|slices|spectra MESH.ply FOLDER [K]\n", argv[0]);
        return 2;
    }
    try {
        const testing::Mesh mesh = testing::readPly(argv[2]);
        return run(task, meshLaplacian(mesh.V, mesh.F, LaplacianKind::Cotangent), argv[3],
                   needsK ? std::atol(argv[4]) : 0);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
        return EXIT_FAILURE;
    }
}
