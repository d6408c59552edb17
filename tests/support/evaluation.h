#pragma once

#include "core/harmonics/harmonic_basis.h"
#include "core/krylov/full_spectrum.h"
#include "core/laplacian/laplacian.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/support/types.h"
#include "core/transfer/transfer_function.h"
#include "support/shapes.h"

namespace spectral::testing {

/// The paper's Laplacian, of cotangents and areas.
/// @param F  triangles; every vertex is in one of them.
Laplacian cotangentLaplacian(const Vertices& V, const Faces& F);

/// A mesh with its cotangent Laplacian.
struct Operator : Laplacian {
    Mesh mesh;

    explicit Operator(const Mesh& m) : Laplacian(cotangentLaplacian(m.V, m.F)), mesh(m) {}

    double area() const { return D.sum(); }
};

/// At least the k lowest harmonics, by truncatedBasis.
HarmonicBasis lowestHarmonics(const Operator& A, Index k, const Progress& progress = {});

/// Y = F(sqrt(A)) V by all eigenvectors: the reference.
Vertices filteredDense(const Operator& A, const HarmonicBasis& dense, const Gain& gain);

/// The same by the rational Krylov method, with the pole that the filter would choose.
/// @param samples  see FullSpectrumOptions.
FullSpectrumResult filteredFullSpectrum(const Operator& A, const Gain& gain, double cutoff,
                                        double accuracy, const std::vector<double>& samples = {});

/// D-inner products of columns, U^T D V.
Eigen::MatrixXd innerProducts(const Eigen::MatrixXd& U, const Eigen::VectorXd& D,
                              const Eigen::MatrixXd& V);

/// Largest entry of |Phi^T D Phi - I|; NaN if one is.
double orthonormalityError(const Eigen::MatrixXd& Phi, const Eigen::VectorXd& D);

/// |difference|_D / |V - mean|_D over all columns together, as FullSpectrumResult measures it.
double relativeError(const Operator& A, const Eigen::MatrixXd& difference);

/// The transfer functions that a rational Krylov method can evaluate, each type and response, with
/// some orders, widths and gains.
std::vector<TransferFunctionOptions> smoothTransferFunctions();

/// A legible name of a transfer function, for messages of failed tests.
std::string describe(const TransferFunctionOptions& options);

}  // namespace spectral::testing
