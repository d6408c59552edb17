"""Shapes of which several tests are made."""

from __future__ import annotations

from typing import Any

import numpy as np
import pymeshlab
from numpy.typing import NDArray
from shared_types import Arrays


def quads(k: NDArray[Any]) -> NDArray[Any]:
    """Return two triangles for each cell of a grid of vertex numbers."""
    a, b, c, d = (one.ravel() for one in (k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]))
    return np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def grid(rows: int, columns: int, *closed: int) -> NDArray[Any]:
    """Return the vertex numbers of a grid; along axes that are closed, the first ones once more."""
    k = np.arange(rows * columns).reshape(rows, columns)
    return np.pad(k, [(0, axis in closed) for axis in range(2)], mode="wrap")


def sphere(subdivisions: int) -> Arrays:
    """Return a sphere of radius 1."""
    made = pymeshlab.MeshSet()
    made.create_sphere(subdiv=subdivisions)
    return made.current_mesh().vertex_matrix(), made.current_mesh().face_matrix()
