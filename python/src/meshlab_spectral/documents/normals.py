"""Normals that follow the shape, and keep hard edges hard."""

from __future__ import annotations

import numpy as np

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
    group = _groups(before, faces, normals, which)
    corner_groups = group[which]
    new, old = (_means(shape, faces, corner_groups, len(normals)) for shape in (after, before))
    moved = np.zeros(len(normals), dtype=bool)
    touched = (after[faces] != before[faces]).any(axis=(1, 2))
    moved[corner_groups[touched]] = True
    # The file's normals may disagree with the orientation of its faces.
    turned = np.einsum("ij,ij->i", _sums(normals, group), old) < 0
    new[turned] *= -1
    length = np.linalg.norm(new, axis=1)
    valid = moved & (length > 0)
    result = normals.copy()
    chosen = valid[group]
    result[chosen] = (new / np.where(length > 0, length, 1.0)[:, None])[group[chosen]]
    return result


def _groups(before: Array, faces: Indices, normals: Array, which: Indices) -> Indices:
    """Assign a number to each normal; equal ones at the same position share it."""
    place = np.full(len(normals), -1, dtype=np.int64)
    place[which.ravel()] = faces.ravel()  # any one of its corners: they share the normal
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
    """Return angle-weighted sums of face normals over the corners of each group, count x 3."""
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
