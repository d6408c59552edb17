#pragma once

#include "core/contract/filter.h"

namespace spectral {

// One function and one file per filter; the two filters of signals share a file.
Filter fractionalFilterContract();  ///< fractional.cpp
Filter denoiseContract();           ///< denoise.cpp
Filter equalizerContract();         ///< equalizer.cpp
Filter qualityContract();           ///< signals.cpp
Filter colorContract();             ///< signals.cpp
Filter artefactsContract();         ///< artefacts.cpp
Filter harmonicsContract();         ///< harmonics.cpp
Filter geometrySpectrumContract();  ///< geometry_spectrum.cpp
Filter surfaceTextureContract();    ///< surface_texture.cpp

}  // namespace spectral
