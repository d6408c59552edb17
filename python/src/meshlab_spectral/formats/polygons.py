"""Triangulation of polygons and triangle strips."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.formats.document import Array, Indices

_ROUND_OFF = 1e-9
# Cutting ears takes the square of the corners where sides cross: 5 s for so many. Sections of CAD
# models have some 20,000.
_MOST_CORNERS = 30_000


def triangles(corners: Indices, sizes: NDArray[np.integer], vertices: Array) -> Indices:
    """Split polygons into triangles, m x 3 vertex indices, in order.

    A polygon becomes a fan around its first corner, as in MeshLab. Where that would fold it, as it
    may a concave one, ears are cut off it. A polygon with fewer than three corners is dropped.
    `corners` are the vertex indices of all polygons, one after the other, `sizes` how many each
    has. Raises ValueError for a polygon that would fold, of more than 30,000 corners.
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
        larger = np.flatnonzero(sizes > 3)
        larger = larger[np.argsort(sizes[larger], kind="stable")]
        groups = np.split(larger, np.flatnonzero(np.diff(sizes[larger])) + 1)
        for which in groups if len(larger) else []:
            size = int(sizes[which[0]])
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
    fan = _fan(P, 0)
    normals = fan.sum(axis=1)
    folded = np.flatnonzero(_folds(fan, normals))
    if size == 4:  # a quadrilateral has one other diagonal
        yield folded[~_folds(_fan(P[folded], 1), normals[folded])], np.array([[1, 2, 3], [1, 3, 0]])
        return
    for polygon in folded.tolist():
        if size > _MOST_CORNERS:
            raise ValueError(f"a polygon has {size} corners, and would fold: split it first")
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
    from mapbox_earcut import triangulate_float64

    turn = np.linalg.svd(normal[None])[2][1:]  # two directions across the normal
    turn[1] *= np.sign(np.linalg.det(np.vstack([turn, normal])))
    Q = np.ascontiguousarray(P @ turn.T)
    found = triangulate_float64(Q, np.array([len(Q)], np.uint32)).astype(np.int64).reshape(-1, 3)
    a, b, c = (Q[found[:, k]] for k in range(3))
    (x, y), along = (b - a).T, c - a
    areas = x * along[:, 1] - y * along[:, 0]
    found[areas < 0] = found[areas < 0][:, ::-1]
    total = np.abs(areas).sum()
    if abs(total - np.linalg.norm(normal)) > _ROUND_OFF * total:
        return None
    ears = _with_all_corners(found.tolist(), len(P))
    return np.array(ears, np.int64) if len(ears) == len(P) - 2 else None


def _with_all_corners(ears: list[list[int]], size: int) -> list[list[int]]:
    """Divide triangles at the corners that were left out, since they lie on a line with others."""
    places = {(one[k], one[k - 2]): row for row, one in enumerate(ears) for k in range(3)}
    used = sorted({corner for one in ears for corner in one})
    for begin, end in zip(used, [*used[1:], *(k + size for k in used[:1])], strict=True):
        row = places.get((begin, end % size), -1)
        for corner in range(begin + 1, end) if row >= 0 else ():
            # The triangle at the side from the corner before to `end` is cut at this one.
            before = (corner - 1) % size if corner > begin + 1 else begin
            third = {*ears[row]} - {before, end % size}
            if len(third) != 1:
                return []
            (apex,) = third
            ears[row] = [before, corner % size, apex]
            places[apex, before] = row
            ears.append([corner % size, end % size, apex])
            row = len(ears) - 1
            places[end % size, apex] = row
    return ears


def strip_triangles(corners: Indices) -> Indices:
    """Split strips, each terminated by -1, into consistently oriented triangles."""
    index = np.arange(len(corners))
    begin = np.maximum.accumulate(np.where(corners < 0, index + 1, 0))
    odd = (index - begin)[:-2] % 2 == 1
    split = np.column_stack([corners[:-2], corners[1:-1], corners[2:]])
    split[odd] = split[odd][:, [0, 2, 1]]
    return split[(split >= 0).all(axis=1)]
