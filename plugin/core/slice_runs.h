#pragma once

#include <Eigen/Core>
#include <vector>

#include "components.h"
#include "laplacian.h"
#include "progress.h"
#include "shifted_ldlt.h"
#include "types.h"

namespace spectral {

/// One Lanczos run of spectrum slicing: a shift, and the eigenpairs round it.
struct SliceRun {
    double sigma = 0.0;
    Index below = 0;         // eigenvalues below sigma, by inertia
    Eigen::VectorXd lambda;  // ascending
    Eigen::MatrixXd Phi;     // n x lambda.size()
    int solves = 0;

    double lowest() const { return lambda.size() > 0 ? lambda[0] : sigma; }
    double highest() const { return lambda.size() > 0 ? lambda[lambda.size() - 1] : sigma; }
};

/// What a run is to find.
struct SliceTask {
    double sigma = 0.0;
    Index down = 0, up = 0;             // pairs below and above the shift, none of them `known`
    const Eigen::MatrixXd* known = {};  // D-orthonormal vectors that it is not to find again
    unsigned seed = 0;
};

/// Does runs on all cores.
class SliceWorkers {
  public:
    /// The arguments are kept by reference.
    SliceWorkers(const Laplacian& laplacian, const ConstantModes& constants);

    /// Does the tasks, each with a factorization of its own; the results are in their order and do
    /// not depend on the number of cores.
    /// @throws SolverFailure  of any run; Cancelled.
    std::vector<SliceRun> execute(const std::vector<SliceTask>& tasks, const Progress& progress);

  private:
    const Laplacian& laplacian_;
    const ConstantModes& constants_;
    std::vector<ShiftedLdlt> factors_;  // one for each worker
};

}  // namespace spectral
