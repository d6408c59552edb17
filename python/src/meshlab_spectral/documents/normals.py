"""Normals that follow the shape, and keep hard edges hard."""

from __future__ import annotations

import numpy as np

from meshlab_spectral.documents.document import Array, Indices


def following_normals(
    before: Array, after: Array, faces: Indices, normals: Array, which: Indices | None = None
) -> Array:
    """Return the normals of a shape whose vertices have moved.

    A normal becomes the mean of those of its corners, weighted by their angles, on the side of the
    surface where it was; one whose corners' triangles have not moved stays as it is. Normals that
    were equal at one place, as along the seams of a texture, stay equal: an edge is as hard as it
    was.

    Parameters
    ----------
    before, after
        n x 3 vertices.
    faces
        m x 3 vertex indices.
    normals
        k x 3.
    which
        The normal of each corner, m x 3; by default normals belong to vertices, k = n.

    Returns
    -------
    k x 3, of unit length where they are new.
    """
    which = faces if which is None else which
    group = _groups(before, faces, normals, which)
    corner_groups = group[which]
    new, old = (_means(shape, faces, corner_groups, len(normals)) for shape in (after, before))
    moved = np.zeros(len(normals), dtype=bool)
    touched = (after[faces] != before[faces]).any(axis=(1, 2))
    moved[corner_groups[touched]] = True
    # On the other side of the surface in a file whose faces are turned.
    turned = np.einsum("ij,ij->i", _sums(normals, group), old) < 0
    new[turned] *= -1
    length = np.linalg.norm(new, axis=1)
    valid = moved & (length > 0)
    result = normals.copy()
    chosen = valid[group]
    result[chosen] = (new / np.where(length > 0, length, 1.0)[:, None])[group[chosen]]
    return result


def _groups(before: Array, faces: Indices, normals: Array, which: Indices) -> Indices:
    """Give every normal a number, the same to those that are equal and at one place."""
    place = np.full(len(normals), -1, dtype=np.int64)
    place[which.ravel()] = faces.ravel()  # of several corners any: they share the normal anyway
    used = np.flatnonzero(place >= 0)
    key = np.hstack([before[place[used]], normals[used]])
    _, first, inverse = np.unique(key + 0.0, axis=0, return_index=True, return_inverse=True)
    group = np.arange(len(normals))
    group[used] = used[first[inverse.ravel()]]
    return group


def _sums(values: Array, group: Indices) -> Array:
    return np.column_stack(
        [np.bincount(group, weights=values[:, c], minlength=len(values)) for c in range(3)]
    )


def _means(vertices: Array, faces: Indices, corner_groups: Indices, count: int) -> Array:
    """Angle-weighted sums of face normals over the corners of each group, count x 3."""
    P = vertices[faces]
    normal = np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0])
    length = np.linalg.norm(normal, axis=1)
    normal /= np.where(length > 0, length, 1.0)[:, None]
    sums = np.zeros((count, 3))
    for c in range(3):
        a, b = P[:, (c + 1) % 3] - P[:, c], P[:, (c + 2) % 3] - P[:, c]
        angle = np.arctan2(length, np.einsum("ij,ij->i", a, b))
        for axis in range(3):
            sums[:, axis] += np.bincount(
                corner_groups[:, c], weights=angle * normal[:, axis], minlength=count
            )
    return sums
