"""Precision of written coordinates: as few digits as the displacements need."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from meshlab_spectral.formats.document import Array
from meshlab_spectral.warned import Warned

# Tolerated rounding error, as a fraction of the displacement.
_TOLERATED = 0.01
SINGLE, DOUBLE = 9, 17  # significant digits for an exact round trip


def in_single_precision(numbers: Array) -> Array:
    """Return numbers as single precision keeps them."""
    with np.errstate(over="ignore"):
        return numbers.astype(np.float32).astype(np.float64)


def rounding_loss(
    before: Array,
    after: Array,
    rounded: Callable[[Array], Array] = in_single_precision,
    kept: str = "single precision",
) -> str | None:
    """Describe the error of writing displacements with few digits; None if it is tolerable.

    It is tolerable if its root mean square over the moved vertices is at most a hundredth of their
    displacement's. `before` and `after` are n x 3, in the coordinates to be written, `rounded` says
    what is left of them, and `kept` what that is called.
    """
    moves = (before != after).any(axis=1)
    if not moves.any():
        return None
    rounding = _size(rounded(after[moves]) - after[moves])
    displacement = _size(after[moves] - before[moves])
    return rounding_message(rounding, displacement, float(np.abs(after).max()), kept)


def rounding_message(
    rounding: float, displacement: float, largest: float, kept: str = "single precision"
) -> str | None:
    """Describe a rounding error, unless it is tolerable for a displacement.

    Both are root mean squares over the moved vertices; `largest` is the largest coordinate.
    """
    if rounding <= _TOLERATED * displacement:
        return None
    verb = "rounds" if kept == "single precision" else "round"
    return (
        f"{kept} {verb} coordinates near {largest:.6g} by {rounding:.2g}, while the "
        f"filter moves vertices by {displacement:.2g} (root mean square)"
    )


def _size(difference: Array) -> float:
    return float(np.sqrt(np.mean((difference**2).sum(axis=1))))


def precision_warnings(
    before: Array,
    after: Array,
    name: str,
    rounded: Callable[[Array], Array] = in_single_precision,
    kept: str = "single precision",
) -> list[Warned]:
    """Return the warning, if any, that the digits in the file `name` are too few."""
    message = rounding_loss(before, after, rounded, kept)
    remedy = "choose .ply or .obj, or move the mesh to the origin first"
    return [Warned("rounded", f"{name}: {message}: {remedy}")] if message else []


def widening_warnings(message: str | None) -> list[Warned]:
    """Return the warning that a file is written in double precision, if `message` says why."""
    text = f"coordinates are written in double precision, since {message}"
    return [Warned("double_precision", text)] if message else []


def digits_for(before: Array, after: Array) -> int:
    """Return the number of significant digits that text needs for the displacements."""
    return SINGLE if rounding_loss(before, after) is None else DOUBLE
