"""Normals and tangents stored with a mesh, which follow when its vertices move.

Libraries store them as data like any other and keep them: VTK even where it is asked to compute
normals. They are recognized by their names.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Share of corners that stand against their faces, from which the orientation of the faces is not
# that of the normals. Noise folds faces, too, but few.
_MIXED = 0.1


def followed(
    data: Mapping[str, Any],
    F: NDArray[np.integer],
    V: Array,
    X: Array,
    *,
    at: str,
    normals: Iterable[str] = (),
) -> dict[str, Any]:
    """Return those arrays in `data` that depend on positions, for vertices moved from V to X.

    Normals are recomputed, on the side of the surface where they were; tangents are made
    perpendicular to them. What has no direction in the new shape stays.

    Parameters
    ----------
    data
        Arrays with a row for each vertex or face.
    F, V, X
        m x 3 corners; n x 3 coordinates before and after.
    at
        "vertices" or "faces", which have the rows.
    normals
        Names of normals that do not tell so.
    """
    at_faces = at == "faces"
    count = len(F) if at_faces else len(V)
    corners: NDArray[np.integer] = np.arange(len(F))[:, None] if at_faces else F
    arrays = {name: np.asarray(values) for name, values in data.items()}
    vectors = {
        name: values
        for name, values in arrays.items()
        if values.ndim == 2
        and values.shape[0] == count
        and values.shape[1] in (3, 4)
        and np.issubdtype(values.dtype, np.floating)
    }
    before, after = _face_normals(V, F), _face_normals(X, F)
    moved: dict[str, Any] = {}
    for name, values in vectors.items():
        if name in normals or (_says(name, "normal") and values.shape[1] == 3):
            moved[name] = _moved(values, corners, before, after)
    for names in _components(arrays, count):
        values = np.column_stack([arrays[name] for name in names])
        columns = _moved(values, corners, before, after).T
        moved |= dict(zip(names, columns, strict=True))
    for name, values in vectors.items():
        if _says(name, "tangent") or _says(name, "binormal"):
            moved[name] = _perpendicular(values, _sums(corners, after, 1.0, count))
    return moved


def _says(name: str, word: str) -> bool:
    plain = name.lower().replace("normalized", "").replace("normalised", "")
    return word in (plain.replace("binormal", "") if word == "normal" else plain)


def _components(arrays: Mapping[str, Any], count: int) -> list[tuple[str, str, str]]:
    """Return the names of normals stored as three arrays: nx, ny and nz, normal_x, ..."""
    found = []
    for name, values in arrays.items():
        stem = name[:-1].lower().rstrip("_:.- ")
        if stem not in ("n", "normal", "normals") or name[-1] not in "xX0":
            continue
        axes = {"x": "yz", "X": "YZ", "0": "12"}[name[-1]]
        names = (name, name[:-1] + axes[0], name[:-1] + axes[1])
        if values.shape == (count,) and all(
            other in arrays and arrays[other].shape == (count,) for other in names
        ):
            found.append(names)
    return found


def _face_normals(V: Array, F: NDArray[np.integer]) -> Array:
    """Return m x 3 normals of faces, as long as twice their areas."""
    a, b, c = (V[F[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)


def _sums(corners: NDArray[np.integer], normals: Array, signs: Any, count: int) -> Array:
    """Return the sums over the corners at each of `count` vertices or faces."""
    sums = np.zeros((count, 3))
    np.add.at(sums, corners, np.broadcast_to(signs, corners.shape)[..., None] * normals[:, None])
    return sums


def _moved(
    given: NDArray[Any], corners: NDArray[np.integer], before: Array, after: Array
) -> NDArray[Any]:
    against = np.einsum("fkd,fd->fk", given[corners], before) < 0
    share = against.mean() if against.size else 0.0
    signs = np.where(against if _MIXED < share < 1 - _MIXED else share > 0.5, -1.0, 1.0)
    sums = _sums(corners, after, signs, len(given))
    return _units(sums, given)


def _perpendicular(given: NDArray[Any], normals: Array) -> NDArray[Any]:
    n = _units(normals, np.zeros_like(normals))
    moved = given.copy()  # the fourth number of a tangent is its sign
    t = given[:, :3] - (given[:, :3] * n).sum(axis=1, keepdims=True) * n
    moved[:, :3] = _units(t, given[:, :3])
    return moved


def _units(vectors: Array, otherwise: NDArray[Any]) -> NDArray[Any]:
    """Return unit vectors in the type of `otherwise`, which stands in for zeros."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    has_direction = np.isfinite(length) & (length > 0)
    units = vectors / np.where(has_direction, length, 1.0)
    return np.where(has_direction, units, otherwise).astype(otherwise.dtype)
