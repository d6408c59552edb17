#include "meshlab/filters/fractional_help.h"

// Three lines, as MeshLab shows all of it above the parameters. What a parameter is about stands in
// its own help.
QString fractionalFilterHelp() {
    return "Smooths, sharpens or enhances details <b>by their size</b>, as an equalizer filters "
           "sound. Low-pass: details larger than the feature size stay, smaller ones go. "
           "<small>Kovnatsky, Bronstein, Bronstein: <i>Stable Spectral Mesh Filtering</i>, "
           "2012</small>";
}
