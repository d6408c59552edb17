#include "filter_help.h"

QString fractionalFilterHelp() {
    return "Filters the shape of the surface by the <b>size of its details</b>, as an equalizer "
           "filters sound: removes small ones (smoothing, denoising), enhances those of a chosen "
           "size, or sharpens."
           "<br><br>The surface is taken apart into its own waves, from the size of the whole "
           "model "
           "down to the finest bumps: the eigenfunctions of its Laplace-Beltrami operator, called "
           "manifold harmonics. Each wave is amplified or damped by its wavelength, compared with "
           "the <b>feature size</b>, which you give as a part of the model's diagonal. One strong "
           "filter would damage the shape, because the waves depend on it; so the filter is "
           "applied "
           "in weak fractional <b>steps</b>, and the waves are taken anew after each."
           "<br><br>Position, topology, colours and all other attributes are kept; only the "
           "vertices move. The surface needs faces, all with an area."
           "<br><br>For more information see:"
           "<br><i>A. Kovnatsky, M. M. Bronstein, A. M. Bronstein</i>, <b>Stable Spectral Mesh "
           "Filtering</b>, ECCV Workshops 2012"
           "<br><i>B. Vallet, B. L&eacute;vy</i>, <b>Spectral Geometry Processing with Manifold "
           "Harmonics</b>, Computer Graphics Forum 27(2), 2008"
           "<br><i>M. Kazhdan, J. Solomon, M. Ben-Chen</i>, <b>Can Mean-Curvature Flow Be Modified "
           "to Be Non-Singular?</b>, Computer Graphics Forum 31(5), 2012 (the conformal update)";
}
