#include "meshlab/filters/fractional_help.h"

// Short: MeshLab shows all of it above the parameters, even on screens of 768 lines.
QString fractionalFilterHelp() {
    return "Filters a shape by the <b>size of its details</b>, as an equalizer filters sound: "
           "smooths, sharpens, or enhances details of one size. A low-pass leaves a quarter of the "
           "height of waves half as long as the <b>feature size</b>, and nine tenths of waves "
           "twice as long."
           "<br><br>The waves are the surface's own (manifold harmonics) [1, 2]. As they change "
           "with the shape, the filter is applied in weak fractional steps. Only vertices move; "
           "holes, degenerate faces and several components are allowed [3]."
           "<br><br><small>[1] Kovnatsky, Bronstein, Bronstein 2012; [2] Vallet, L&eacute;vy 2008; "
           "[3] Sharp, Crane 2020; [4] Kazhdan, Solomon, Ben-Chen 2012</small>";
}
