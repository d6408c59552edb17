#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/mesh.h"

namespace spectral {

/// The slopes of heights that are linear on each triangle of a reference surface.
struct TextureSlopes {
    double Sdq = 0.0;  ///< Root mean square of the slope.
    double Sdr = 0.0;  ///< Additional area of the surface, relative to the reference's.
};

/// The parameters of ISO 25178-2 of heights over a reference surface, by its areas.
struct TextureParameters : TextureSlopes {
    double Sa = 0.0;  ///< Mean of |height|, length units; the next four are lengths, too.
    double Sq = 0.0;  ///< Root mean square of the height.
    double Sp = 0.0, Sv = 0.0, Sz = 0.0;    ///< Highest peak, deepest valley, their sum.
    double Ssk = 0.0, Sku = 0.0;            ///< Skewness and kurtosis of the heights; 0 if Sq is 0.
    double Sk = 0.0, Spk = 0.0, Svk = 0.0;  ///< Core height, reduced peaks and valleys, lengths.
    double Smr1 = 0.0, Smr2 = 0.0;          ///< Material ratios at the ends of the core, 0 to 1.
    double area = 0.0;  ///< Of the reference surface where it is evaluated, length squared.
    double flat = 0.0;  ///< Share of it in triangles with heights below a thousandth of Sq.

    Eigen::VectorXd histogramHeights;  ///< Centres of `kHistogramBins` equal bins, ascending.
    Eigen::VectorXd histogramShares;   ///< Share of the area in each bin.
    /// The bearing curve of Abbott and Firestone: the heights that 0, 1, ..., 100 % of the area
    /// exceed, 101 descending lengths.
    Eigen::VectorXd bearingHeights;
};

constexpr int kHistogramBins = 64;

/// @param h          n heights above the reference along its normals, length units.
/// @param reference  n x 3 positions.
/// The parameters of the core are those of ISO 25178-2 (ISO 13565-2): the line nearest to the 40 %
/// of the bearing curve whose secant is flattest spans the core, from its heights at 0 to 100 %.
///
/// @param counts     n, whether each vertex is evaluated; some vertex with an area is.
TextureParameters textureParameters(const Eigen::VectorXd& h, const Vertices& reference,
                                    const Faces& F, const std::vector<bool>& counts);

/// Over the triangles whose corners all count; parameters as those of textureParameters.
TextureSlopes slopesOf(const Eigen::VectorXd& h, const Vertices& reference, const Faces& F,
                       const std::vector<bool>& counts);

}  // namespace spectral
