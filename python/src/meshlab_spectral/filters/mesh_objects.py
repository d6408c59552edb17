"""Meshes of other libraries: recognized by an attribute, and returned as their own type.

None of these libraries is imported: whoever passes such a mesh has done so.
"""

from __future__ import annotations

import copy
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MeshKind:
    """The mesh class of a library.

    Attributes
    ----------
    name
        The library and the class.
    mark
        An attribute that distinguishes the class from the kinds before it.
    arrays
        Returns the n x 3 coordinates and m x 3 vertex indices of a mesh.
    moved
        Returns a copy of a mesh with new coordinates, n x 3.
    """

    name: str
    mark: str
    arrays: Callable[[Any], tuple[Any, Any]]
    moved: Callable[[Any, Array], Any]


def kind_of(mesh: Any) -> MeshKind | None:
    """Return the kind of a mesh; None if it is of none of these libraries."""
    return next((kind for kind in _KINDS if hasattr(type(mesh), kind.mark)), None)


def known_kinds() -> str:
    """Return the names of the classes that `kind_of` knows."""
    return ", ".join(kind.name for kind in _KINDS)


def owned_mesh(mesh_set: Any) -> Any:
    """Return the current mesh of a `pymeshlab.MeshSet`, which then lives as long as the mesh."""
    mesh = mesh_set.current_mesh()
    weakref.finalize(mesh, id, mesh_set)  # only keeps the MeshSet alive
    return mesh


def _pymeshlab_arrays(mesh: Any) -> tuple[Any, Any]:
    if not mesh.is_compact():
        raise ValueError("the mesh has deleted elements: call its compact() first")
    return mesh.vertex_matrix(), mesh.face_matrix()


def _not_moved(mesh: Any, V: Array) -> Any:
    raise NotImplementedError("pymeshlab sets no coordinates: filter a copy, see owned_mesh")


def _pyvista_arrays(mesh: Any) -> tuple[Any, Any]:
    if not mesh.is_all_triangles:
        raise ValueError("the mesh has faces that are not triangles: call its triangulate() first")
    return mesh.points, mesh.regular_faces


def _pyvista_moved(mesh: Any, V: Array) -> Any:
    moved = mesh.copy()
    moved.points = V.astype(mesh.points.dtype)
    if "Normals" in moved.point_data:
        moved.compute_normals(
            cell_normals=False,
            split_vertices=False,
            consistent_normals=False,
            auto_orient_normals=False,
            inplace=True,
        )
    return moved


def _meshio_arrays(mesh: Any) -> tuple[Any, Any]:
    surfaces = sorted(set(mesh.cells_dict) - {"vertex", "line"})
    if surfaces != ["triangle"]:
        raise ValueError(f"the mesh has cells {', '.join(surfaces)}: pass a mesh of triangles only")
    return mesh.points, mesh.cells_dict["triangle"]


def _meshio_moved(mesh: Any, V: Array) -> Any:
    moved = copy.deepcopy(mesh)
    moved.points = V.astype(mesh.points.dtype)
    return moved


def _open3d_moved(mesh: Any, V: Array) -> Any:
    moved = type(mesh)(mesh)
    moved.vertices = type(mesh.vertices)(V)
    if moved.has_triangle_normals():
        moved.compute_triangle_normals()
    if moved.has_vertex_normals():
        moved.compute_vertex_normals()
    return moved


def _trimesh_moved(mesh: Any, V: Array) -> Any:
    moved = mesh.copy()
    moved.vertices = V
    return moved


PYMESHLAB = MeshKind("pymeshlab.Mesh", "face_matrix", _pymeshlab_arrays, _not_moved)
_KINDS = (
    PYMESHLAB,
    MeshKind("pyvista.PolyData", "regular_faces", _pyvista_arrays, _pyvista_moved),
    MeshKind("meshio.Mesh", "cells_dict", _meshio_arrays, _meshio_moved),
    MeshKind(
        "open3d.geometry.TriangleMesh",
        "triangle_normals",
        lambda mesh: (np.asarray(mesh.vertices), np.asarray(mesh.triangles)),
        _open3d_moved,
    ),
    MeshKind("trimesh.Trimesh", "faces", lambda mesh: (mesh.vertices, mesh.faces), _trimesh_moved),
)
