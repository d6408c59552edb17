"""The filter's gain as a function of frequency, for plots; the same formulas as the plugin's."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.filters.options import FilterOptions

Array = NDArray[np.float64]


def gain(options: FilterOptions, x: Array) -> Array:
    """Gain F of a filter, (stop_gain + (pass_gain - stop_gain) B(x))^power.

    Parameters
    ----------
    options
        Options of the filter.
    x
        Relative frequencies omega / omega_c = feature size / wavelength, >= 0.

    Returns
    -------
    array
        The gains. The constant mode of a surface always has gain 1, whatever F(0) is.
    """
    B = 1 - _prototype(options, x) if options.filter_type == "band-stop" else _prototype(options, x)
    whole: Array = options.stop_gain + (options.pass_gain - options.stop_gain) * B
    return whole**options.power


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
