"""Validation of meshes given as arrays; vertex areas and edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def mesh_arrays(
    vertices: ArrayLike, faces: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Validate and convert the arrays of a mesh; pymeshlab would misread or reject them silently.

    Parameters
    ----------
    vertices
        n x 3 coordinates.
    faces
        m x 3 indices of the corners of triangles, from 0 to n - 1.

    Raises
    ------
    ValueError
        When an array has the wrong shape or type, or an index is out of range.
    """
    V, F = np.asarray(vertices, dtype=np.float64), np.asarray(faces)
    if V.ndim != 2 or V.shape[1] != 3:
        raise ValueError(f"vertices have shape {V.shape}: pass n x 3 coordinates")
    if len(V) == 0:
        raise ValueError("there are no vertices: pass a mesh")
    if F.ndim != 2 or F.shape[1] != 3 or not np.issubdtype(F.dtype, np.integer):
        raise ValueError(
            f"faces have shape {F.shape} and type {F.dtype}: pass m x 3 integers, the corners of "
            "triangles"
        )
    if F.size and (F.min() < 0 or F.max() >= len(V)):
        wrong = F.min() if F.min() < 0 else F.max()
        raise ValueError(f"a face refers to vertex {wrong}, but there are {len(V)} vertices")
    return V, F.astype(np.int32)


def lumped_areas(V: NDArray[np.float64], F: NDArray[np.integer]) -> NDArray[np.float64]:
    """Vertex areas, a third of the area of the incident triangles each: the diagonal of D."""
    a, b, c = (V[F[:, corner]] for corner in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    lumped = np.zeros(len(V))
    np.add.at(lumped, F, areas[:, None] / 3)
    return lumped


def mean_edge(V: NDArray[np.float64], F: NDArray[np.integer]) -> float:
    """Mean side length over all triangles; 0 without triangles."""
    if len(F) == 0:
        return 0.0
    return float(np.linalg.norm(V[F] - V[np.roll(F, 1, axis=1)], axis=2).mean())
