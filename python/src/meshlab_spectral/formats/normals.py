"""Normals that follow the shape, and keep hard edges hard."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral import _core
from meshlab_spectral.formats.document import Array, Indices


def following_normals(
    before: Array, after: Array, faces: Indices, normals: Array, which: Indices | None = None
) -> Array:
    """Return the normals, k x 3, of a shape whose vertices (n x 3) have moved; see shapes.h.

    `which` are the indices of each corner's normal, m x 3 as `faces`; by default there is one for
    each vertex. Normals whose triangles have not moved are kept; new ones have unit length.
    """
    which = faces if which is None else which
    return _core.following_normals(before, after, faces, normals, which)


def following_face_normals(
    before: Array, after: Array, faces: Indices, normals: Array, owners: Indices | None = None
) -> Array:
    """Return the same for normals of faces, k x 3; each is on its side of the surface, as it was.

    `owners` are the faces of the triangles, m of k; by default the triangles themselves.
    """
    owners = np.arange(len(faces)) if owners is None else owners
    return _core.following_face_normals(before, after, faces, normals, owners)


def area_vectors(V: Array, F: NDArray[np.integer]) -> Array:
    """Return the m x 3 normals of triangles, as long as their areas."""
    a, b, c = (V[F[:, corner]] for corner in range(3))
    vectors: Array = np.cross(b - a, c - a) / 2
    return vectors


def vertex_normals(V: Array, F: NDArray[np.integer]) -> Array:
    """Return the n x 3 normals of vertices, weighted by area: unit vectors, or zeros."""
    sums = np.zeros_like(V)
    np.add.at(sums, F, area_vectors(V, F)[:, None])
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    normals: Array = np.divide(sums, lengths, out=sums, where=lengths > 0)
    return normals


def are_normals(vectors: Any, count: int) -> bool:
    """Whether an array holds vectors of unit length at the vertices."""
    if vectors.shape != (count, 3) or vectors.dtype.kind != "f":
        return False
    return bool(np.allclose(np.linalg.norm(vectors, axis=1), 1, atol=1e-3))
