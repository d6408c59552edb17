"""Formats in which MeshLab writes coordinates with fewer digits than it has."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from meshlab_spectral.formats.digits import in_single_precision, precision_warnings
from meshlab_spectral.formats.document import Array
from meshlab_spectral.warned import Warned


def _decimals(numbers: Array) -> Array:
    return np.round(numbers, 6)


def _six_digits(numbers: Array) -> Array:
    size = np.where(numbers == 0, 1.0, np.abs(numbers))
    step = 10.0 ** (np.floor(np.log10(size)) - 5)
    return np.asarray(np.round(numbers / step) * step, dtype=np.float64)


# Their extensions: what is left of coordinates, and what that is called.
_ROUNDED: dict[str, tuple[Callable[[Array], Array], str]] = {
    **dict.fromkeys(("stl", "3ds", "ctm", "nxs"), (in_single_precision, "single precision")),
    **dict.fromkeys(("dae", "json", "wrl", "x3d"), (_six_digits, "six digits")),
    **dict.fromkeys(("3mf", "dxf", "idtf", "xyz"), (_decimals, "six decimals")),
}


def rounding_warnings(before: Array, after: Array, scratch: Path) -> list[Warned]:
    """Return the warning, if any, that MeshLab writes this format with too few digits."""
    rounded = _ROUNDED.get(scratch.suffix[1:].lower())
    if rounded is None or before.shape != after.shape:
        return []
    return precision_warnings(before, after, scratch.name, *rounded)
