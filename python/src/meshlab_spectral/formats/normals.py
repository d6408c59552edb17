"""Normals that follow the shape, and keep hard edges hard."""

from __future__ import annotations

from typing import Any

import numpy as np

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


def are_normals(vectors: Any, count: int) -> bool:
    """Whether an array holds vectors of unit length at the vertices."""
    if vectors.shape != (count, 3) or vectors.dtype.kind != "f":
        return False
    return bool(np.allclose(np.linalg.norm(vectors, axis=1), 1, atol=1e-3))
