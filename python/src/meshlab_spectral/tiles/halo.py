"""How far a filter reaches: the width of what tiles need around their cells."""

from __future__ import annotations

import numpy as np

from meshlab_spectral.errors import UntiledError
from meshlab_spectral.filters.arrays import Lengths
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.transfer import MeshLengths, gain
from meshlab_spectral.formats.document import Array
from meshlab_spectral.tiles.noise import REACH

# Largest difference to the filter of the whole mesh that a halo may cause, relative to the
# diagonal.
_TOLERATED = 5e-7
# The gain is sampled up to this relative frequency, above which a taper ends it: edges are finer
# than the feature size by less.
_HIGHEST, _SAMPLES, _TAPER = 16.0, 1 << 17, 8.0
# While a filter draws in a shape, its kernels grow a little, as measured on the input.
_GROWTH = 1.25
# The effect around a selection ends within one feature size; the width of its fading must not feel
# where a tile ends.
_SELECTION = 3.0
# So near to where a tile was cut, it seems to be thin: thin parts have sizes of their own.
_THIN = 0.5


def require_local(options: Options) -> None:
    """Raise UntiledError unless a filter only depends on what is near each vertex."""
    if not isinstance(options, FilterOptions):
        if getattr(options, "store_noise_height", False):
            raise UntiledError("store_noise_height is not written in tiles: choose another value")
        return
    reasons = {
        "laplacian = uniform measures sizes by the whole mesh": options.laplacian == "uniform",
        "spectrum = truncated needs the harmonics of the whole mesh": options.spectrum
        == "truncated",
        "response = ideal reaches across the whole mesh": options.response == "ideal"
        and options.filter_type != "custom",
        "basis_update = full reaches beyond tiles in more than one step": options.basis_update
        == "full"
        and options.steps != 1,
        "preserve_volume measures the whole mesh": options.preserve_volume,
        "result = details is not written in tiles": options.result == "details",
    }
    for reason, is_so in reasons.items():
        if is_so:
            raise UntiledError(f"{reason}: choose another value")


def reach_of(options: Options, whole: Lengths) -> float:
    """Return the distance from which nothing changes a vertex noticeably, in length units.

    Raises UntiledError when the filter moves whole components, and OptionError when its transfer
    function is invalid.
    """
    require_local(options)
    if not isinstance(options, FilterOptions):
        return REACH * whole.mean_edge
    sizes = options.sizes(whole.diagonal, whole.mean_edge, whole.surface_diagonal)
    length = sizes["feature_size"] or 0.0
    x = np.linspace(0.0, _HIGHEST, _SAMPLES + 1)
    x[0] = 1e-3 * x[1]  # where no logarithm fails
    gains = gain(options, x, MeshLengths(length, whole.diagonal, whole.mean_edge))
    if abs(gains[0] - 1) > 1e-6:
        raise UntiledError(
            f"the gain of the largest details is {gains[0]:.3g}: in tiles it must be 1 (for a "
            "high-pass or band-pass, stop_gain = 1)"
        )
    if np.ptp(gains) == 0:
        return 2 * whole.mean_edge
    tails = kernel_tails(gains)
    spacing = 1 / (2 * _HIGHEST)
    tolerated = _TOLERATED * whole.surface_diagonal / length
    enough = np.flatnonzero(tails <= tolerated)
    across = whole.surface_diagonal / length
    halo = _GROWTH * (enough[0] if len(enough) else len(tails)) * spacing
    if options.selected:
        halo = max(halo, _SELECTION)
    if options.filter_type == "low-pass":
        halo += _THIN
    return float(min(halo, across) * length + 2 * whole.mean_edge)


def kernel_tails(gains: Array) -> Array:
    """Return how much a border at a distance of h can change: 2 * integral of |K| beyond h.

    Beyond a straight border the surface is mirrored instead of going on. Coordinates grow no faster
    than distances, so those there are wrong by at most twice the distance from the border. K(x) is
    the integral beyond x of the filter's kernel across the border, the cosine transform of the
    gain; partial integration gives the bound. `gains` are at relative frequencies 0 to _HIGHEST,
    evenly spaced; the result is in feature sizes, for h = 0, 1, ... times 1 / (2 * _HIGHEST).
    """
    x = np.linspace(0.0, _HIGHEST, len(gains))
    # A constant gain has no kernel beyond the vertex itself.
    decaying = (gains - gains[-1]) * np.exp(-((x / _TAPER) ** 8))
    kernel = np.fft.irfft(decaying)[: len(gains)]  # times the spacing
    kernel[np.abs(kernel) < 1e-15 * np.abs(kernel).max()] = 0.0  # round-off
    beyond = np.cumsum(kernel[::-1])[::-1] - kernel / 2
    sizes = np.abs(beyond)
    return np.asarray((np.cumsum(sizes[::-1])[::-1] - sizes / 2) / _HIGHEST)
