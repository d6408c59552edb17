"""Cells that divide space, with about as many vertices of a surface in each: leaves of a k-d tree.

A tree is the number of a cell, or an axis, a position on it, and the trees below and above it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from meshlab_spectral.formats.document import Array, Indices

Tree = Any  # int | tuple[int, float, Tree, Tree], or lists from JSON


def split(points: Array, cells: int, first: int = 0) -> Tree:
    """Divide the space around points into cells, numbered from `first`."""
    if cells == 1 or len(points) < 2:
        return first
    axis, left = int(np.argmax(np.ptp(points, axis=0))), cells // 2
    at = float(np.quantile(points[:, axis], left / cells))
    is_below = points[:, axis] <= at
    below = split(points[is_below], left, first)
    return axis, at, below, split(points[~is_below], cells - left, first + left)


def near_cells(
    tree: Tree, low: Array, high: Array, reach: float, rows: Indices | None = None
) -> Iterator[tuple[int, Indices]]:
    """Yield each cell with the boxes, k x 3 corners, that are within reach of it along each axis.

    A point is a box; without reach it is in one cell.
    """
    if rows is None:
        rows = np.arange(len(low))
    if not len(rows):
        return
    if isinstance(tree, int):
        yield tree, rows
        return
    axis, at, below, above = tree
    yield from near_cells(below, low, high, reach, rows[low[rows, axis] <= at + reach])
    yield from near_cells(above, low, high, reach, rows[high[rows, axis] > at - reach])
