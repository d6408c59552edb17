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

struct BandEnergy {
    double energy = 0.0;  ///< length^4, >= 0.
    double change = 0.0;  ///< Change of the energy when the Krylov space grew by half, >= 0.
};

/// Gauss quadratures from a Krylov space at two stages of its growth.
struct MeasureInSpace {
    Quadrature smaller, larger;
    /// Range of frequencies resolved.
    double from = 0.0, to = std::numeric_limits<double>::infinity();
};

/// The spectral measure of a signal, summed over its columns: the distribution of its energy over
/// frequency.
///
/// One part may be known exactly, from a basis of harmonics. The rest is estimated by Gauss
/// quadrature in several Krylov spaces, each of which resolves its own range of frequencies: around
/// its pole or, without a pole, the highest.
class SpectralMeasure {
  public:
    /// @param exact  the exact part of the measure.
    explicit SpectralMeasure(Quadrature exact) : exact_(std::move(exact)) {}

    /// Adds another estimate of the rest.
    void add(MeasureInSpace space) { spaces_.push_back(std::move(space)); }

    /// Energy sum_i e_i g(omega_i) in the window g of band j, from the space where it changed
    /// least.
    BandEnergy in(const Bands& bands, int j) const;

    /// The measure as estimated in the first space; the exact part if there is none.
    Quadrature first() const;

    /// The measure as estimated in the last space; the exact part if there is none.
    Quadrature last() const;

  private:
    Quadrature exact_;
    std::vector<MeasureInSpace> spaces_;
};

struct ShapeAndNoise {
    SpectralMeasure shape, noise;
};

/// Adds the measures estimated in Krylov spaces of S.
/// @param signals    n x (3 + 1), without the exact parts: the shape, then the noise.
/// @param dimension  dimension of the larger spaces, >= 3; the smaller ones have two thirds of it.
/// @throws SolverFailure, Cancelled.
void addMeasures(const KrylovOperator& S, const Laplacian& laplacian,
                 const Eigen::MatrixXd& signals, int dimension, const Progress& progress,
                 ShapeAndNoise& measures);

}  // namespace spectral
