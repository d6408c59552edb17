#include "fractional_help.h"

// Short: MeshLab shows all of it above the parameters, on screens of 768 lines, too.
QString fractionalFilterHelp() {
    return "Filters the shape by the <b>size of its details</b>, as an equalizer filters sound: "
           "smooths, sharpens, or enhances the details of one size."
           "<br><br>The <b>feature size</b> is where the filter turns over: the wavelength of a "
           "wave along the surface, a bump and the hollow beside it. To remove bumps, try twice "
           "their width. The waves are the surface's own, the eigenfunctions of its "
           "Laplace-Beltrami operator (manifold harmonics) [1, 2]; as they change with the shape, "
           "a strong filter is applied in weak fractional <b>steps</b>, and the waves are taken "
           "anew after each, so that thin parts do not turn into spikes [1]."
           "<br><br>Only vertices move. Holes, several parts and degenerate faces do not disturb "
           "[3]; the rims of holes move, too, unless you fix the boundary."
           "<br><br><small>[1] Kovnatsky, Bronstein, Bronstein: <b>Stable Spectral Mesh "
           "Filtering</b>, 2012"
           "<br>[2] Vallet, L&eacute;vy: <b>Spectral Geometry Processing with Manifold "
           "Harmonics</b>, 2008"
           "<br>[3] Sharp, Crane: <b>A Laplacian for Nonmanifold Triangle Meshes</b>, 2020"
           "<br>[4] Kazhdan, Solomon, Ben-Chen: <b>Can Mean-Curvature Flow Be Modified to Be "
           "Non-singular?</b>, 2012</small>";
}
