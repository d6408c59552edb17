"""Normals that follow the shape, and keep hard edges hard."""

from __future__ import annotations

from meshlab_spectral import _core
from meshlab_spectral.documents.document import Array, Indices


def following_normals(
    before: Array, after: Array, faces: Indices, normals: Array, which: Indices | None = None
) -> Array:
    """Return the updated normals of a shape whose vertices have moved.

    A new normal is the angle-weighted mean of the face normals at its corners, on the side of the
    surface where it was; a normal whose triangles have not moved is kept. Normals that were equal
    at the same position, as along texture seams, stay equal: hard edges stay hard, smooth ones
    smooth.

    Parameters
    ----------
    before, after
        n x 3 vertices.
    faces
        m x 3 vertex indices.
    normals
        k x 3.
    which
        m x 3 indices of each corner's normal; by default `faces`: one normal per vertex, k = n.

    Returns
    -------
    k x 3; new normals have unit length.
    """
    which = faces if which is None else which
    return _core.following_normals(before, after, faces, normals, which)
