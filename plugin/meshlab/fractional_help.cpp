#include "fractional_help.h"

// Short: MeshLab shows all of it above the parameters, on screens of 768 lines, too.
QString fractionalFilterHelp() {
    return "Filters the shape by the <b>size of its details</b>, as an equalizer filters sound: "
           "smooths, sharpens, or enhances the details of one size."
           "<br><br>The <b>feature size</b> is where the filter turns over: the wavelength of a "
           "wave along the surface, a bump and the hollow beside it. To remove bumps, try twice "
           "their width. A low-pass leaves a quarter of the height of waves half as long, and nine "
           "tenths of waves twice as long."
           "<br><br>The waves are the surface's own, the eigenfunctions of its Laplace-Beltrami "
           "operator (manifold harmonics) [1, 2]. As they change with the shape, a strong filter "
           "is applied in weak fractional <b>steps</b>, and they are taken anew after each, in "
           "whole [1] or in part [4], so that thin parts do not turn into spikes. Only vertices "
           "move. Holes, several parts and degenerate faces do no harm [3]; the rims of holes "
           "move, too, unless you fix the boundary."
           "<br><br><small>[1] Kovnatsky, Bronstein, Bronstein: Stable Spectral Mesh Filtering, "
           "2012"
           "<br>[2] Vallet, L&eacute;vy: Spectral Geometry Processing with Manifold Harmonics, 2008"
           "<br>[3] Sharp, Crane: A Laplacian for Nonmanifold Triangle Meshes, 2020"
           "<br>[4] Kazhdan et al.: Can Mean-Curvature Flow Be Modified to Be Non-singular?, 2012"
           "</small>";
}
