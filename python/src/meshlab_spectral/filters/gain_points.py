"""Gains that are Python functions, as the points that the plugin takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import mean_edge
from meshlab_spectral.filters.options import FilterOptions

# Between points the plugin interpolates the gain's logarithm, here to about 1e-5 of a smooth gain;
# beyond them, where no mesh has details, the gain stays as it is.
_OCTAVES, _PER_OCTAVE = 16, 128

# The plugin takes a gain of exactly 0 for one that cannot be seen, 1e-3.
_NO_GAIN = 1e-12


def points_of(gain: Callable[[float], float], feature_size: float) -> str:
    """Sample a gain, for the option `transfer_function`, as points `size:gain`.

    `gain` is a function of w = feature size / wavelength, w > 0; finite, >= 0. The points are at
    the feature size, a length > 0, and 16 octaves on both sides. Raises OptionError when a gain is
    negative or not finite; says where.
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
    """Return the options with a gain of the user, a function of w, for a mesh.

    Raises OptionError as `points_of`, or when the options have a filter type of their own.
    """
    if options.filter_type != "low-pass":
        raise OptionError(f"filter_type = {options.filter_type}: gain takes its place; give one")
    diagonal = float(np.linalg.norm(np.ptp(V, axis=0)))
    size = options.feature_size.in_units_of_mesh(diagonal, mean_edge(V, F))
    points = points_of(gain, size)
    return replace(options, filter_type="custom", transfer_function=points)
