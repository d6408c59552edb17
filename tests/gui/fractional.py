"""The filter "Spectral Filter (Fractional)", and the meshes before and after it."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pymeshlab
from meshlab_spectral import FilterOptions
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshlab import MeshLab

MENU = ("Smoothing, Fairing and Deformation", "Spectral Filter (Fractional)")
FILTER = "apply_coord_spectral_filter_fractional"
# Of the dialog, which has two of its own.
PARAMETERS = [
    *(option.name for option in fields(FilterOptions)),
    "color_by_displacement",
    "keep_original",
]

# The faces of the bunny's head, and qualities from 0 to 1, as MeshLab's expressions.
HEAD = "y0 > 0.33"
WEIGHT = "0.5 + 0.5 * sin(40 * z)"

# Half a unit in the last place of a float near 1, the bunny's size, with room for rounding the
# filter's own parameters, which MeshLab holds as floats, too.
FLOAT_PRECISION = 4 * 2.0**-24


def load(path: Path) -> pymeshlab.MeshSet:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(path))
    return mesh_set


def save_shape(mesh_set: pymeshlab.MeshSet, path: Path) -> Path:
    """Save nothing but the shape: MeshLab then shows it in its own colour, grey."""
    mesh_set.save_current_mesh(
        str(path), save_vertex_color=False, save_vertex_quality=False, save_vertex_normal=False
    )
    return path


def vertices(mesh_set: pymeshlab.MeshSet) -> NDArray[np.float64]:
    return mesh_set.current_mesh().vertex_matrix().copy()


def saved_vertices(meshlab: MeshLab, name: str = "saved.ply") -> NDArray[np.float64]:
    path = meshlab.home / name
    meshlab.save_mesh(path)
    return vertices(load(path))


def mean_edge(mesh_set: pymeshlab.MeshSet) -> float:
    V, F = vertices(mesh_set), mesh_set.current_mesh().face_matrix()
    return float(np.linalg.norm(V[F] - V[np.roll(F, 1, axis=1)], axis=2).mean())


def default_feature_size(mesh_set: pymeshlab.MeshSet) -> float:
    """Return the default feature size of the filter: six mean edges, at most 5 %."""
    return min(6 * mean_edge(mesh_set), 0.05 * diagonal(vertices(mesh_set)))


def diagonal(V: NDArray[Any]) -> float:
    return float(np.linalg.norm(np.ptp(V, axis=0)))


def assert_same_in_floats(A: NDArray[Any], B: NDArray[Any]) -> None:
    assert A.shape == B.shape
    assert np.abs(A - B).max() <= FLOAT_PRECISION * diagonal(B)
