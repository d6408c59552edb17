"""Digits of coordinates: as few as hold a movement."""

from __future__ import annotations

import numpy as np

from meshlab_spectral.documents.document import Array

# Rounding may take this part of the displacement.
_TOLERATED = 0.01
SINGLE, DOUBLE = 9, 17  # significant digits that hold a number of that precision


def rounding_told(before: Array, after: Array) -> str | None:
    """Return how single precision rounds a movement, or None where it holds it.

    It does if rounding takes, in the root mean square over what moves, at most a hundredth of the
    displacement. `before` and `after` are n x 3, in the coordinates to be written.
    """
    moves = (before != after).any(axis=1)
    if not moves.any():
        return None
    with np.errstate(over="ignore"):
        rounding = _size(after[moves].astype(np.float32) - after[moves])
    displacement = _size(after[moves] - before[moves])
    if rounding <= _TOLERATED * displacement:
        return None
    largest = float(np.abs(after).max())
    return (
        f"single precision rounds coordinates near {largest:.6g} by {rounding:.2g}, where the "
        f"filter moves by {displacement:.2g} (root mean square)"
    )


def _size(difference: Array) -> float:
    return float(np.sqrt(np.mean(difference**2)))


def precision_warnings(before: Array, after: Array, name: str) -> list[str]:
    """Return the warning, if any, of a file `name` of single precision for a movement."""
    told = rounding_told(before, after)
    remedy = "choose .ply or .obj, or move the mesh to the origin first"
    return [f"{name}: {told}: {remedy}"] if told else []


def widening_warnings(told: str | None) -> list[str]:
    """Return the warning, if any, of a file that is written in double precision, see above."""
    return [f"coordinates are written in double precision, since {told}"] if told else []


def digits_for(before: Array, after: Array) -> int:
    """Return how many significant digits a text needs to hold a movement."""
    return SINGLE if rounding_told(before, after) is None else DOUBLE
