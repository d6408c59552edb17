#include "meshlab/filters/fractional_help.h"

// Short: MeshLab shows all of it above the parameters, on screens of 768 lines, too.
QString fractionalFilterHelp() {
    return "Filters the shape by the <b>size of its details</b>, as an equalizer filters sound: "
           "smooths, sharpens, or enhances the details of one size. A low-pass leaves a quarter of "
           "the height of waves half as long as the <b>feature size</b>, and nine tenths of waves "
           "twice as long."
           "<br><br>The waves are the surface's own (manifold harmonics) [1, 2]. As they change "
           "with the shape, the filter is applied in weak fractional steps. Only vertices move; "
           "holes, several parts and degenerate faces do no harm [3]."
           "<br><br><small>[1] Kovnatsky, Bronstein, Bronstein 2012; [2] Vallet, L&eacute;vy 2008; "
           "[3] Sharp, Crane 2020; [4] Kazhdan, Solomon, Ben-Chen 2012</small>";
}
