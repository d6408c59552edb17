"""The filter's gain as a function of frequency, for plots; the same formulas as the plugin's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.plugin.library import custom_gains

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MeshLengths:
    """Lengths that the sizes of a custom transfer function refer to, in the units of the mesh.

    Attributes
    ----------
    feature_size
        The filter's feature size.
    diagonal
        Diagonal of the bounding box.
    mean_edge
        Mean edge length.
    """

    feature_size: float
    diagonal: float
    mean_edge: float


def gain(options: FilterOptions, x: Array, lengths: MeshLengths | None = None) -> Array:
    """Gain F of a filter, (stop_gain + (pass_gain - stop_gain) B(x))^power, or that of the user.

    Parameters
    ----------
    options
        Options of the filter.
    x
        Relative frequencies omega / omega_c = feature size / wavelength, >= 0; > 0 for a custom
        transfer function.
    lengths
        Those of the mesh, for a custom transfer function.

    Returns
    -------
    array
        The gains. The constant mode of a surface always has gain 1, whatever F(0) is.

    Raises
    ------
    OptionError
        When a custom transfer function is wrong; the message says where.
    """
    if options.filter_type == "custom":
        return _custom(options, np.asarray(x, dtype=np.float64), lengths) ** options.power
    B = 1 - _prototype(options, x) if options.filter_type == "band-stop" else _prototype(options, x)
    whole: Array = options.stop_gain + (options.pass_gain - options.stop_gain) * B
    return whole**options.power


def _custom(options: FilterOptions, x: Array, lengths: MeshLengths | None) -> Array:
    if lengths is None:
        raise OptionError("a custom transfer function needs a mesh that its sizes refer to")
    return custom_gains(
        options.transfer_function,
        lengths.feature_size,
        lengths.diagonal,
        lengths.mean_edge,
        lengths.feature_size / x,
    )


def _prototype(options: FilterOptions, x: Array) -> Array:
    """Prototype B(x), 1/sqrt(2) (-3 dB) at the cutoff; a band-stop uses the band-pass's."""
    # Frequency of the equivalent low-pass, with its cutoff at 1; may be infinite at x = 0.
    with np.errstate(divide="ignore", over="ignore"):
        y = _as_low_pass(options, np.asarray(x, dtype=np.float64))
        if options.response == "gaussian":
            B = np.exp2(-(y**2) / 2)
        elif options.response == "butterworth":
            B = 1 / np.sqrt(1 + y ** (2 * options.order))
        else:
            B = np.where(y <= 1, 1.0, 0.0)
    return B


def _as_low_pass(options: FilterOptions, x: Array) -> Array:
    if options.filter_type == "low-pass":
        return x
    if options.filter_type == "high-pass":
        return 1 / x
    b = options.band_width
    if options.response == "butterworth":
        return np.abs(x - 1 / x) / (2 ** (b / 2) - 2 ** (-b / 2))
    return 2 * np.abs(np.log2(x)) / b
