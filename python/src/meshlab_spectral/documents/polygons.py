"""Triangulation of polygons and triangle strips."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.documents.document import Array, Indices


def triangles(corners: Indices, sizes: NDArray[np.integer], vertices: Array) -> Indices:
    """Split polygons into triangles, in order.

    A quadrilateral is split along the diagonal that folds it less, in a tie along the first; a
    larger polygon becomes a fan around its first corner; one with fewer than three corners is
    dropped.

    Parameters
    ----------
    corners
        Vertex indices of all polygons, one after the other.
    sizes
        Number of corners of each polygon.
    vertices
        n x 3.

    Returns
    -------
    m x 3 vertex indices.
    """
    if (sizes == 3).all():
        return corners.reshape(-1, 3)
    return corners[corners_of_triangles(corners, sizes, vertices)]


def corners_of_triangles(corners: Indices, sizes: NDArray[np.integer], vertices: Array) -> Indices:
    """Return the triangles of `triangles` as m x 3 positions in `corners`.

    They map data of corners, such as normals, to the triangles, too.
    """
    sizes = np.asarray(sizes, dtype=np.int64)
    if (sizes == 3).all():
        return np.arange(len(corners), dtype=np.int64).reshape(-1, 3)
    begins = np.cumsum(sizes) - sizes
    fans = np.maximum(sizes - 2, 0)
    owner = np.repeat(np.arange(len(sizes)), fans)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(fans) - fans, fans)
    begin = begins[owner]
    split = np.column_stack([begin, begin + step + 1, begin + step + 2])
    quads = np.flatnonzero(sizes == 4)
    if quads.size:
        first = begins[quads]
        turned = _folds(vertices[corners[first[:, None] + np.arange(4)]])
        rows = (np.cumsum(fans) - fans)[quads[turned]]
        q = first[turned]
        split[rows] = np.column_stack([q + 1, q + 2, q + 3])
        split[rows + 1] = np.column_stack([q + 1, q + 3, q])
    return split


def strip_triangles(corners: Indices) -> Indices:
    """Split strips, each terminated by -1, into consistently oriented triangles."""
    place = np.arange(len(corners))
    begin = np.maximum.accumulate(np.where(corners < 0, place + 1, 0))
    odd = (place - begin)[:-2] % 2 == 1
    split = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
    split[odd] = split[odd][:, [0, 2, 1]]
    return split[(split >= 0).all(axis=1)]


def _folds(P: Array) -> NDArray[np.bool_]:
    """Whether each quadrilateral (q x 4 x 3) folds more along 0-2 than along 1-3."""

    def cosine(a: int, b: int, c: int, d: int) -> Array:
        first = np.cross(P[:, b] - P[:, a], P[:, c] - P[:, a])
        second = np.cross(P[:, c] - P[:, a], P[:, d] - P[:, a])
        size = np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1)
        dot: Array = np.einsum("ij,ij->i", first, second)
        return np.where(size > 0, dot / np.where(size > 0, size, 1.0), -1.0)

    tie = 1e-6
    return cosine(1, 2, 3, 0) > cosine(0, 1, 2, 3) + tie
