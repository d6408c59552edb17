"""Triangulation of polygons and triangle strips."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.documents.document import Array, Indices

_ROUND_OFF = 1e-9


def triangles(corners: Indices, sizes: NDArray[np.integer], vertices: Array) -> Indices:
    """Split polygons into triangles, in order.

    A polygon becomes a fan around its first corner, as in MeshLab. Where that would fold it, as it
    may a concave one, the fan is around the next corner that does not, and if there is none, ears
    are cut off. A polygon with fewer than three corners is dropped.

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

    They map data of corners, such as normals, to the triangles, too. Corners may be out of range:
    their polygons become fans.
    """
    sizes = np.asarray(sizes, dtype=np.int64)
    if (sizes == 3).all():
        return np.arange(len(corners), dtype=np.int64).reshape(-1, 3)
    begins = np.cumsum(sizes) - sizes
    fans = np.maximum(sizes - 2, 0)
    rows = np.cumsum(fans) - fans  # the first triangle of each polygon
    owner = np.repeat(np.arange(len(sizes)), fans)
    step = np.arange(len(owner)) - rows[owner]
    begin = begins[owner]
    split = np.column_stack([begin, begin + step + 1, begin + step + 2])
    with np.errstate(all="ignore"):
        for size in np.unique(sizes[sizes > 3]).tolist():
            which = np.flatnonzero(sizes == size)
            polygons = corners[begins[which, None] + np.arange(size)]
            within = ((polygons >= 0) & (polygons < len(vertices))).all(axis=1)
            which, polygons = which[within], polygons[within]
            for chosen, places in _unfolded(vertices[polygons]):
                row = rows[which[chosen], None] + np.arange(size - 2)
                split[row] = begins[which[chosen], None, None] + places
    return split


def _unfolded(P: Array) -> Iterator[tuple[Indices, Indices]]:
    """Yield those of the polygons, q x k x 3, that a fan around the first corner folds.

    With some of them come the places of the corners, (k - 2) x 3, of triangles that do not.
    """
    size = P.shape[1]
    normals = _fan(P, 0).sum(axis=1)
    folded = np.flatnonzero(_folds(_fan(P, 0), normals))
    for first in range(1, size):
        around = _folds(_fan(P[folded], first), normals[folded])
        step = np.arange(size - 2)
        fan = np.column_stack([0 * step, step + 1, step + 2])
        yield folded[~around], (first + fan) % size
        folded = folded[around]
        if not len(folded):
            return
    for polygon in folded.tolist() if size > 4 else []:  # a quadrilateral has no other triangles
        ears = _ears(P[polygon], normals[polygon])
        if ears is not None:
            yield np.array([polygon]), ears


def _fan(P: Array, first: int) -> Array:
    """Return the area vectors, q x (k - 2) x 3, of the triangles of fans around a corner."""
    sides = np.roll(P, -first, axis=1)[:, 1:] - P[:, first, None]
    return np.cross(sides[:, :-1], sides[:, 1:])


def _folds(areas: Array, normals: Array) -> NDArray[np.bool_]:
    """Whether some triangles of a polygon face away from it, by more than round-off."""
    along = np.einsum("qti,qi->qt", areas, normals)
    folds: NDArray[np.bool_] = (along < -_ROUND_OFF * (normals**2).sum(axis=1)[:, None]).any(axis=1)
    return folds


def _ears(P: Array, normal: Array) -> Indices | None:
    """Triangulate a polygon, k x 3, by cutting off ears; None if it crosses itself."""
    turn = np.linalg.svd(normal[None])[2][1:]  # two directions across the normal
    turn[1] *= np.sign(np.linalg.det(np.vstack([turn, normal])))
    Q = P @ turn.T
    left, found = list(range(len(P))), list[tuple[int, int, int]]()

    def is_ear(a: int, b: int, c: int) -> bool:
        if _turn(Q[a], Q[b], Q[c]) <= 0:
            return False
        others = Q[[k for k in left if k not in (a, b, c)]]
        corners = ((a, b), (b, c), (c, a))
        inside = np.all([_turn(Q[i], Q[j], others) >= 0 for i, j in corners], axis=0)
        return not (inside & ~(others[:, None] == Q[[a, b, c]]).all(axis=2).any(axis=1)).any()

    while len(left) > 3:
        corners = zip([left[-1], *left], left, [*left[1:], left[0]], strict=False)
        ear = next((three for three in corners if is_ear(*three)), None)
        if ear is None:
            return None
        found.append(ear)
        left.remove(ear[1])
    return np.array([*found, tuple(left)], dtype=np.int64)


def _turn(a: Array, b: Array, c: Array) -> Any:
    """Return twice the area of plane triangles, positive if they turn left."""
    (x, y), along = b - a, c - a
    return x * along[..., 1] - y * along[..., 0]


def strip_triangles(corners: Indices) -> Indices:
    """Split strips, each terminated by -1, into consistently oriented triangles."""
    place = np.arange(len(corners))
    begin = np.maximum.accumulate(np.where(corners < 0, place + 1, 0))
    odd = (place - begin)[:-2] % 2 == 1
    split = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
    split[odd] = split[odd][:, [0, 2, 1]]
    return split[(split >= 0).all(axis=1)]
