#pragma once

#include <Eigen/Core>

#include "progress.h"

namespace spectral {

/// The manifold harmonic transform Phi^T D X (Vallet and Levy 2008), on all cores: Phi n x k, D the
/// n masses, X n x c. The result does not depend on the number of cores.
/// @throws Cancelled
Eigen::MatrixXd harmonicTransform(const Eigen::Ref<const Eigen::MatrixXd>& Phi,
                                  const Eigen::VectorXd& D, const Eigen::MatrixXd& X,
                                  const Progress& progress = {});

/// Its inverse Phi C, on all cores: C k x c.
Eigen::MatrixXd inverseHarmonicTransform(const Eigen::Ref<const Eigen::MatrixXd>& Phi,
                                         const Eigen::MatrixXd& C, const Progress& progress = {});

}  // namespace spectral
