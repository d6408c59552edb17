#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/filter/full_spectrum_evaluator.h"
#include "core/laplacian/laplacian_builder.h"
#include "core/support/progress.h"
#include "core/transfer/transfer_function.h"

namespace spectral {

/// Relative to the size of what is filtered: of a shape, roughness is a thousandth.
constexpr double kTextureAccuracy = 1e-6;

/// Of a nesting index, squared: that of a second low-pass, whose difference to the first one tells
/// how a surface bends (SeparatedSignal). Any other share would do.
constexpr double kBend = 0.5;

/// What is left of a signal by the S- and L-filters, its reference, and how accurately.
struct SeparatedSignal {
    Eigen::MatrixXd waviness;  ///< The signal without noise and roughness; 0 without an L-filter.
    Eigen::MatrixXd roughness;
    Eigen::MatrixXd bend;  ///< What a low-pass at kBend of the cutoff leaves, but not the waviness.
    double errorEstimate = 0.0;  ///< Root mean square, units of the signal.
    bool accuracyReached = true;
};

/// The filters of ISO 25178-3 with the Gaussian of ISO 16610-61, on one surface: those of all
/// nesting indices are fractional powers of one, and share its factorization if there is any.
class TextureFilters {
  public:
    /// @param mesh  kept by reference.
    /// @param size  nesting index for which they are tuned, > 0.
    TextureFilters(const MeshLaplacian& mesh, double size);

    /// Low-passes of n x c signals at nesting indices, the largest first.
    Evaluation lowPasses(const Eigen::MatrixXd& X, const std::vector<double>& sizes,
                         double accuracy, const Progress& progress);

    /// @param X                n x c signals.
    /// @param waviness, noise  nesting indices of the L- and the S-filter; 0: none.
    SeparatedSignal separated(const Eigen::MatrixXd& X, double waviness, double noise,
                              const Progress& progress);

    /// What of heights varies more slowly than a size: their low-pass, a mean over those that are
    /// far from ends. Heights at creases are far larger, and would draw the form of the flanks with
    /// them. It is taken on cells a 32nd of that size, as form varies so slowly, and then over
    /// the steps between them.
    ///
    /// @param h       n heights.
    /// @param isFar   n, whether each counts.
    /// @param smooth  n x 3, the surface without roughness.
    /// @param size    nesting index.
    Eigen::VectorXd formOf(const Eigen::VectorXd& h, const std::vector<bool>& isFar,
                           const Vertices& smooth, double size, const Progress& progress);

  private:
    const MeshLaplacian& mesh_;
    double size_;
    TransferFunction gaussian_;
    FullSpectrumEvaluator evaluator_;
};

}  // namespace spectral
