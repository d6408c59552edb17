"""The filter's gain as a function of frequency, for plots; the core computes it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral import _core
from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import real_numbers
from meshlab_spectral.filters.options import FilterOptions

Array = NDArray[np.float64]

TRANSFER_NAMES = (
    "filter_type",
    "pass_gain",
    "stop_gain",
    "transfer_function",
    "band_width",
    "response",
    "order",
    "power",
)


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

    `x` are relative frequencies omega / omega_c = feature size / wavelength, >= 0. A custom
    transfer function needs the `lengths` of the mesh. Returns gains at `x`; the constant mode of a
    surface always has gain 1, whatever the gain at 0. Raises OptionError when a custom transfer
    function is invalid; the message says where.
    """
    if lengths is None:
        if options.filter_type == "custom":
            raise OptionError(
                "a custom transfer function needs the lengths of a mesh for its sizes"
            )
        lengths = MeshLengths(1.0, 1.0, 1.0)
    parameters = {
        name: value for name, value in options.core_parameters().items() if name in TRANSFER_NAMES
    }
    w = np.ascontiguousarray(real_numbers(x, "x"))
    gains = _core.gains(
        parameters, lengths.feature_size, lengths.diagonal, lengths.mean_edge, w.ravel()
    )
    return gains.reshape(w.shape)
