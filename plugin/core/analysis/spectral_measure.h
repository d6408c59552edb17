#pragma once

#include <Eigen/Core>
#include <limits>
#include <utility>
#include <vector>

#include "core/analysis/bands.h"
#include "core/krylov/krylov_operator.h"
#include "core/krylov/krylov_spaces.h"
#include "core/support/progress.h"

namespace spectral {

/// An energy, and by how much it changed when the Krylov space grew by half; both length^4, >= 0.
struct BandEnergy {
    double energy = 0.0, change = 0.0;
};

/// Gauss quadrature in a Krylov space, and when that was smaller.
struct MeasureInSpace {
    Quadrature smaller, larger;
    double from = 0.0, to = std::numeric_limits<double>::infinity();  ///< What it resolves.
};

/// The spectral measure of a signal, over all its columns: how much of its energy is at which
/// frequency.
///
/// Some of it may be known exactly, in a basis of harmonics. The rest is known from Gauss
/// quadrature in several Krylov spaces, each of which resolves frequencies of its own: those around
/// its pole or, without one, the highest.
class SpectralMeasure {
  public:
    /// @param exact  part of the measure.
    explicit SpectralMeasure(Quadrature exact) : exact_(std::move(exact)) {}

    /// Adds another estimate of the rest.
    void add(MeasureInSpace space) { spaces_.push_back(std::move(space)); }

    /// Energy sum_i e_i g(omega_i) in the window g of band j, from the space where it changed
    /// least.
    BandEnergy in(const Bands& bands, int j) const;

    /// The measure as the first of the spaces has it, or its exact part without one.
    Quadrature first() const;

    /// The measure as the last of the spaces has it, or its exact part without one.
    Quadrature last() const;

  private:
    Quadrature exact_;
    std::vector<MeasureInSpace> spaces_;
};

struct ShapeAndNoise {
    SpectralMeasure shape, noise;
};

/// Adds what Krylov spaces of S see.
/// @param signals    n x (3 + 1), without the exact parts: the shape, then the noise.
/// @param dimension  >= 3; two thirds of it when smaller.
/// @throws SolverFailure, Cancelled.
void addMeasures(const KrylovOperator& S, const Laplacian& laplacian,
                 const Eigen::MatrixXd& signals, int dimension, const Progress& progress,
                 ShapeAndNoise& measures);

}  // namespace spectral
