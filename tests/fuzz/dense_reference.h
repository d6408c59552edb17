#pragma once

#include <array>
#include <optional>

#include "core/laplacian/interior.h"
#include "core/laplacian/laplacian_builder.h"

namespace spectral::fuzz {

/// How a dense reference is computed. If double precision disagrees with a result, the extended one
/// decides; its differences from the perturbed ones are its uncertainty.
enum class Precision {
    Double,     ///< Eigenpairs in double precision, the rest in long double.
    Extended,   ///< long double, which on some systems is double.
    Perturbed,  ///< Extended, with all vertices in another order and round-off in every number.
    PerturbedAgain
};

/// All eigenpairs of a Laplacian, and the shape in them.
struct DenseSpectrum {
    Eigen::VectorXd lambda;    ///< m, ascending, >= 0.
    Eigen::MatrixXd Phi;       ///< m x m, D-orthonormal.
    Eigen::MatrixXd c;         ///< m x 3, Phi^T D U.
    Eigen::VectorXd energies;  ///< m, of U in each harmonic.

    /// F(sqrt(A)) U - U for the gains at all m frequencies, m x 3.
    Eigen::MatrixXd change(const Eigen::VectorXd& gains) const;
};

/// The Laplacian of a mesh with all its eigenvectors, by Eigen's dense solver.
class DenseReference {
  public:
    /// The mesh must be one that the core accepts.
    DenseReference(const Vertices& V, const Faces& F, LaplacianKind kind, Boundary boundary);

    const MeshLaplacian& mesh() const { return mesh_; }
    const Interior& interior() const { return interior_; }
    const Laplacian& laplacian() const { return laplacian_; }  ///< For the m interior vertices.
    Index size() const { return interior_.size(); }

    const DenseSpectrum& at(Precision precision);

  private:
    MeshLaplacian mesh_;
    Interior interior_;
    Laplacian laplacian_;
    std::array<std::optional<DenseSpectrum>, 4> spectra_;
};

}  // namespace spectral::fuzz
