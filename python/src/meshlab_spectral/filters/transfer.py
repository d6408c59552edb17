"""The filter's gain as a function of frequency, for plots; the plugin computes it."""

from __future__ import annotations

import ctypes
from dataclasses import astuple, dataclass
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.options import FilterOptions, FilterType, Response
from meshlab_spectral.plugin.library import function_of
from meshlab_spectral.plugin.loading import load, loaded_plugin

Array = NDArray[np.float64]

_INTEGER, _NUMBERS = ctypes.c_int, ctypes.POINTER(ctypes.c_double)


@dataclass(frozen=True)
class MeshLengths:
    """Lengths that the sizes of a custom transfer function refer to, in the units of the mesh.

    They are the filter's feature size, the diagonal of the bounding box and the mean edge length.
    """

    feature_size: float
    diagonal: float
    mean_edge: float


def gain(options: FilterOptions, x: Array, lengths: MeshLengths | None = None) -> Array:
    """Compute the gain of a filter, (stop_gain + (pass_gain - stop_gain) B(x))^power or custom.

    Parameters
    ----------
    options
        Options of the filter.
    x
        Relative frequencies omega / omega_c = feature size / wavelength, >= 0.
    lengths
        Lengths of the mesh, which a custom transfer function needs.

    Returns
    -------
    array
        Gains at `x`. The constant mode of a surface always has gain 1, whatever the gain at 0.

    Raises
    ------
    OptionError
        When a custom transfer function is invalid; the message says where.
    PluginError
        When the plugin cannot be loaded.
    """
    if lengths is None:
        if options.filter_type == "custom":
            raise OptionError(
                "a custom transfer function needs the lengths of a mesh for its sizes"
            )
        lengths = MeshLengths(1.0, 1.0, 1.0)
    load()
    types = (_INTEGER, _INTEGER, _NUMBERS, ctypes.c_char_p, _NUMBERS, _NUMBERS, _INTEGER, _NUMBERS)
    function = function_of(loaded_plugin(), "meshlab_spectral_gains", types)
    shape = [options.order, options.band_width, options.pass_gain, options.stop_gain, options.power]
    gains = np.empty(np.shape(x))
    given = [np.ascontiguousarray(one, dtype=np.float64) for one in (shape, astuple(lengths), x)]
    numbers = [array.ctypes.data_as(_NUMBERS) for array in (*given, gains)]
    mistake: bytes | None = function(
        get_args(FilterType).index(options.filter_type),
        get_args(Response).index(options.response),
        numbers[0],
        options.transfer_function.encode(),
        *numbers[1:3],
        gains.size,
        numbers[3],
    )
    if mistake is not None:
        raise OptionError(mistake.decode())
    return gains
