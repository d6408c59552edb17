"""Normals and tangents stored with a mesh, which follow when its vertices move.

Libraries store them as data like any other and keep them: VTK even where it is asked to compute
normals. They are recognized by their names.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.formats.normals import (
    area_vectors,
    following_face_normals,
    following_normals,
    vertex_normals,
)

Array = NDArray[np.float64]

# Share of faces that stand against the normals of their corners, from which their orientation is
# not that of the normals. Noise folds faces, too, but few.
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

    Normals turn as the surface does, as those of files do; tangents are made perpendicular to them.
    What has no direction in the new shape stays. The arrays have a row for each of the m triangles
    F, or of the n vertices: `at` says "faces" or "vertices". `normals` are the names of normals
    that do not tell so.
    """
    at_faces = at == "faces"
    count = len(F) if at_faces else len(V)
    arrays = {name: np.asarray(values) for name, values in data.items()}
    vectors = {
        name: values
        for name, values in arrays.items()
        if values.ndim == 2
        and values.shape[0] == count
        and values.shape[1] in (3, 4)
        and np.issubdtype(values.dtype, np.floating)
    }
    V, X = (np.ascontiguousarray(points, np.float64) for points in (V, X))
    moved: dict[str, Any] = {}
    for name, values in vectors.items():
        if name in normals or (_says(name, "normal") and values.shape[1] == 3):
            moved[name] = _moved(values, V, X, F, at_faces)
    for names in _components(arrays, count):
        values = np.column_stack([arrays[name] for name in names])
        columns = _moved(values, V, X, F, at_faces).T
        moved |= dict(zip(names, columns, strict=True))
    for name, values in vectors.items():
        if _says(name, "tangent") or _says(name, "binormal"):
            moved[name] = _perpendicular(
                values, area_vectors(X, F) if at_faces else vertex_normals(X, F)
            )
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


def _moved(
    given: NDArray[Any], V: Array, X: Array, F: NDArray[np.integer], at_faces: bool
) -> NDArray[Any]:
    normals, faces = np.ascontiguousarray(given, np.float64), F.astype(np.int64)
    if at_faces:
        moved = following_face_normals(V, X, faces, normals)
    else:
        corners = np.einsum("fkd,fd->fk", normals[faces], area_vectors(V, faces)) < 0
        against = corners.sum(axis=1) > 1
        if _MIXED < (against.mean() if against.size else 0.0) < 1 - _MIXED:
            faces = np.where(against[:, None], faces[:, [0, 2, 1]], faces)
            before, after = (vertex_normals(points, faces) for points in (V, X))
            turn = (before != after).any(axis=1, keepdims=True)
            normals = np.where(turn, _units(before, normals), normals)
        moved = following_normals(V, X, faces, normals)
    return moved.astype(given.dtype)


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
