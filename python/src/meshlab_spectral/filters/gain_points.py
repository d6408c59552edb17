"""Sampling of gains given as Python functions, for the plugin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import mean_edge
from meshlab_spectral.filters.options import FilterOptions

# The plugin interpolates the gain's logarithm between points, here to about 1e-5 of a smooth gain;
# beyond them, where no mesh has details, the gain is constant.
_OCTAVES, _PER_OCTAVE = 16, 128

# The plugin replaces a gain of exactly 0 by 1e-3, which is not visible.
_NO_GAIN = 1e-12


def points_of(gain: Callable[[float], float], feature_size: float) -> str:
    """Sample a gain, for the option `transfer_function`, as points `size:gain`.

    `gain` is a function of w = feature size / wavelength > 0. The points extend 16 octaves to both
    sides of `feature_size`, a length > 0. Raises OptionError, which names w, when a gain is
    negative or not finite.
    """
    points = []
    for w in np.exp2(np.arange(-_OCTAVES * _PER_OCTAVE, _OCTAVES * _PER_OCTAVE + 1) / _PER_OCTAVE):
        value = float(gain(float(w)))
        if not (np.isfinite(value) and value >= 0):
            raise OptionError(
                f"gain({w:.3g}) = {value}: must be finite and not negative for every w > 0, the "
                "feature size over the wavelength"
            )
        points.append(f"{feature_size / w:.17g}:{max(value, _NO_GAIN):.17g}")
    return ",".join(points)


def with_gain(
    options: FilterOptions,
    gain: Callable[[float], float],
    V: NDArray[np.float64],
    F: NDArray[np.integer],
) -> FilterOptions:
    """Return the options with the user's `gain`, a function of w, sampled for a mesh.

    Raises OptionError as `points_of` does, or when the options choose a filter type, too.
    """
    if options.filter_type != "low-pass":
        raise OptionError(
            f"filter_type = {options.filter_type}: gain replaces it; give one of them"
        )
    # As in the plugin, percentages refer to all vertices, and the default to those of faces.
    shape = V[F].reshape(-1, 3) if options.feature_size.automatic and len(F) else V
    diagonal = float(np.linalg.norm(np.ptp(shape, axis=0)))
    size = options.feature_size.in_units_of_mesh(diagonal, mean_edge(V, F))
    points = points_of(gain, size)
    return replace(options, filter_type="custom", transfer_function=points)
