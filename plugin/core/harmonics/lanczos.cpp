#include "core/harmonics/lanczos.h"

#include <Spectra/SymEigsSolver.h>

#include <exception>
#include <string>

#include "core/support/errors.h"

namespace spectral {

namespace {

/// A SymmetricOperator with the interface that Spectra requires.
class SpectraOperator {
  public:
    using Scalar = double;

    SpectraOperator(const SymmetricOperator& S, Index n) : S_(S), n_(n) {}

    Index rows() const { return n_; }
    Index cols() const { return n_; }
    void perform_op(const double* in, double* out) const {
        Eigen::Map<Eigen::VectorXd>(out, n_) = S_(Eigen::Map<const Eigen::VectorXd>(in, n_));
    }

  private:
    const SymmetricOperator& S_;
    Index n_;
};

}  // namespace

Eigenpairs largestPairs(const SymmetricOperator& S, Index n, Index wanted,
                        const LanczosOptions& options) {
    SpectraOperator op(S, n);
    try {
        Spectra::SymEigsSolver<SpectraOperator> solver(op, wanted, options.dimension);
        solver.init();
        if (solver.compute(Spectra::SortRule::LargestMagn, options.maxRestarts, options.tolerance) >
            0)
            return {solver.eigenvalues(), solver.eigenvectors()};
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {  // a breakdown in Spectra
        throw SolverFailure(ErrorCode::BasisIncomplete,
                            std::string("the harmonics could not be computed: ") + error.what());
    }
    throw SolverFailure(ErrorCode::BasisIncomplete, "the harmonics did not converge");
}

}  // namespace spectral
