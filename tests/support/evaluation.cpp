#include "support/evaluation.h"

#include <sstream>

#include "core/harmonics/truncated_basis.h"
#include "core/krylov/pole_selection.h"
#include "core/mesh/mesh.h"
#include "core/transfer/transfer_function.h"

namespace spectral::testing {

Laplacian cotangentLaplacian(const Vertices& V, const Faces& F) {
    const Eigen::VectorXd D = lumpedMass(V, F);
    return {cotangentStiffness(V, F), D, ConstantModes(connectedComponents(F, V.rows()), D)};
}

HarmonicBasis lowestHarmonics(const Operator& A, Index k, const Progress& progress) {
    ShiftedLdlt ldlt;
    return truncatedBasis(A, k, ldlt, progress);
}

Vertices filteredDense(const Operator& A, const HarmonicBasis& dense, const Gain& gain) {
    return applyInBasis(dense, A, gain, 0.0, A.mesh.V);
}

FullSpectrumResult filteredFullSpectrum(const Operator& A, const Gain& gain, double cutoff,
                                        double accuracy, const std::vector<double>& samples) {
    ShiftedLdlt ldlt;
    ldlt.factorizeDefinite(A.W, A.D, selectPole(gain, cutoff, bulkSpectrum(A), accuracy));
    FullSpectrumOptions options;
    options.accuracy = accuracy;
    options.samples = samples;
    options.roundOffAtVertices = roundOffAtVertices(ldlt, A);
    return applyFullSpectrum(A, ShiftInvert(ldlt), {gain}, A.mesh.V, options).front();
}

Eigen::MatrixXd innerProducts(const Eigen::MatrixXd& U, const Eigen::VectorXd& D,
                              const Eigen::MatrixXd& V) {
    const Eigen::MatrixXd DV = D.asDiagonal() * V;
    return U.transpose() * DV;
}

double orthonormalityError(const Eigen::MatrixXd& Phi, const Eigen::VectorXd& D) {
    const Eigen::MatrixXd gram = innerProducts(Phi, D, Phi);
    return (gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols()))
        .cwiseAbs()
        .maxCoeff<Eigen::PropagateNaN>();
}

double relativeError(const Operator& A, const Eigen::MatrixXd& difference) {
    Eigen::MatrixXd centred = A.mesh.V;
    A.constants.remove(A.D, centred);
    const Eigen::VectorXd sqrtD = A.D.cwiseSqrt();
    return (sqrtD.asDiagonal() * difference).norm() / (sqrtD.asDiagonal() * centred).norm();
}

std::vector<TransferFunctionOptions> smoothTransferFunctions() {
    std::vector<TransferFunctionOptions> all;
    for (const FilterType type :
         {FilterType::LowPass, FilterType::HighPass, FilterType::BandPass, FilterType::BandStop})
        for (const Response response : {Response::Gaussian, Response::Butterworth})
            for (const int order : {1, 2, 4})
                for (const auto& [pass, stop] : {std::pair{1.0, 0.0}, {2.5, 1.0}}) {
                    if (response == Response::Gaussian && order != 2) continue;
                    TransferFunctionOptions options;
                    options.type = type;
                    options.response = response;
                    options.order = order;
                    options.passGain = pass;
                    options.stopGain = stop;
                    all.push_back(options);
                }
    return all;
}

std::string describe(const TransferFunctionOptions& options) {
    const char* types[] = {"low-pass", "high-pass", "band-pass", "band-stop", "custom"};
    const char* responses[] = {"gaussian", "butterworth", "ideal"};
    std::ostringstream text;
    text << types[static_cast<int>(options.type)] << " "
         << responses[static_cast<int>(options.response)] << " order " << options.order << " width "
         << options.bandWidth << " gains " << options.passGain << "/" << options.stopGain;
    return text.str();
}

}  // namespace spectral::testing
