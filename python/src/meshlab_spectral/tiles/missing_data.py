"""The edges of a mesh that is read in chunks, without walls around missing data (measures.h)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.formats.document import Array
from meshlab_spectral.formats.rows import MeshRows, chunks

_LONGER = 6  # by exponents of 2: sides that may be walls
_EXPONENTS = 2048  # of doubles; the last is that of infinity
_ROUND_OFF = 1e-6  # of a plane in single precision, relative to its size


class Sides:
    """Sides of triangles: their sum, and how many have each exponent of 2."""

    def __init__(self) -> None:
        self._total = 0.0
        self._counts = np.zeros(_EXPONENTS, np.int64)

    def add(self, lengths: Array) -> None:
        """Add the lengths of sides."""
        self._total += float(lengths.sum())
        self._counts += np.bincount(_exponents(lengths), minlength=_EXPONENTS)

    def without_missing(
        self, mesh: MeshRows, low: Array, high: Array
    ) -> tuple[float, Array, Array]:
        """Return the mean side and the corners of the box, `low` and `high`, without missing data.

        These are the lowest or highest along an axis, if all others are farther from them than from
        each other. Sides that may be walls are rare: only then the mesh is read once more.
        """
        count = int(self._counts.sum())
        longest = int(np.searchsorted(2 * np.cumsum(self._counts), count)) + _LONGER
        if not self._counts[longest + 1 : -1].any():
            return self._total / count, low, high
        above, below = np.full(3, np.inf), np.full(3, -np.inf)  # the values next to low and high
        found = [np.zeros((2, 0, 3))]
        for i, j in chunks(mesh.faces):
            X = mesh.corners_of(mesh.triangles(i, j))
            for k, corners in enumerate(X):
                above = np.minimum(above, np.where(corners > low, corners, np.inf).min(axis=0))
                below = np.maximum(below, np.where(corners < high, corners, -np.inf).max(axis=0))
                ends = np.stack([corners, X[k - 1]])
                is_long = _exponents(np.linalg.norm(ends[0] - ends[1], axis=1)) > longest
                is_outer = ((ends == low) | (ends == high)).any(axis=(0, 2))
                found.append(ends[:, is_long & is_outer])
            mesh.forget()
        planes = np.array([np.linalg.norm(np.delete(high - low, axis)) for axis in range(3)])

        def are_missing(spread: Array, gap: Array) -> NDArray[np.bool_]:
            return np.asarray((spread > _ROUND_OFF * planes) & (gap > spread))

        at_low, at_high = (
            are_missing(high - above, above - low),
            are_missing(below - low, high - below),
        )
        ends = np.concatenate(found, axis=1)
        is_apart = ((at_low & (ends == low)) | (at_high & (ends == high))).any(axis=2)
        walls = ends[:, is_apart[0] != is_apart[1]]
        lengths = np.linalg.norm(walls[0] - walls[1], axis=1)
        mean = float((self._total - lengths.sum()) / (count - len(lengths)))
        return mean, np.where(at_low, above, low), np.where(at_high, below, high)


def _exponents(lengths: Array) -> NDArray[np.int64]:
    return lengths.view(np.int64) >> 52 & 0x7FF
