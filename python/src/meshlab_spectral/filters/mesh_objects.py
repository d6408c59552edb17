"""Meshes of other libraries: recognized by an attribute, and returned as their own type.

None of these libraries is imported: whoever passes such a mesh has done so.
"""

from __future__ import annotations

import copy
import functools
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import ArgumentError, ArrayError
from meshlab_spectral.filters.mesh_normals import followed
from meshlab_spectral.formats.normals import are_normals, following_normals
from meshlab_spectral.other_words import instead_of
from meshlab_spectral.plugin.mesh_sets import written_copy

Function = TypeVar("Function", bound=Callable[..., Any])
Array = NDArray[np.float64]


@dataclass(frozen=True)
class MeshKind:
    """The mesh class of a library."""

    name: str  # the library and the class
    mark: str  # an attribute that distinguishes the class from the kinds before it
    # Returns the n x 3 coordinates and m x 3 vertex indices of a mesh.
    arrays: Callable[[Any], tuple[Any, Any]]
    # Returns a copy of a mesh with new coordinates, n x 3; what it stores of the old ones, such as
    # normals, follows.
    moved: Callable[[Any, Array], Any]
    # Returns the arrays at the vertices of a mesh, by name.
    data: Callable[[Any], Mapping[str, Any]] = lambda mesh: {}


def kind_of(mesh: Any) -> MeshKind | None:
    """Return the kind of a mesh; None if it is of none of these libraries."""
    if _is_pair(mesh):
        return _PAIR
    return next((kind for kind in _KINDS if hasattr(type(mesh), kind.mark)), None)


def known_kinds() -> str:
    """Return the names of the classes that `kind_of` knows."""
    return ", ".join(kind.name for kind in (*_KINDS, _PAIR))


def remedy_for(mesh: Any) -> str | None:
    """Return what to do with an object that is not a mesh but holds some, or None."""
    classes = [one.__name__ for one in type(mesh).__mro__]
    return next((remedy for name, remedy in _REMEDIES.items() if name in classes), None)


def array_of(mesh: Any, values: Any, name: str) -> Any:
    """Return `values`, or where this is a text, the array at the vertices that it names.

    `name` is that of the argument, for the ArrayError when the mesh has no such array.
    """
    if not isinstance(values, str):
        return values
    kind = kind_of(mesh)
    if kind is None:
        raise ArrayError(f"{name} = {values!r}: vertices and faces have no named arrays; pass one")
    data = kind.data(mesh)
    if values not in data:
        raise ArrayError(
            f"{name} = {values!r}: the mesh has no such array at its vertices; "
            f"it has {', '.join(map(repr, data)) or 'none'}"
        )
    return data[values]


def takes_mesh_alone(function: Function) -> Function:
    """Let a mesh stand for vertices and faces where arguments are given by position.

    The function's first two arguments are vertices and faces. With a mesh, ``f(mesh, x)`` means
    ``f(mesh, None, x)``.
    """
    parameters = inspect.signature(function).parameters
    third = list(parameters)[2]
    takes_any = any(one.kind is inspect.Parameter.VAR_KEYWORD for one in parameters.values())

    @functools.wraps(function)
    def shifted(*args: Any, **kwargs: Any) -> Any:
        has_more = len(args) > 1 and args[1] is not None and kind_of(args[0]) is not None
        # A matrix that cannot be the third argument is meant as faces, an error.
        if has_more and (third in ("values", "colors") or np.ndim(args[1]) < 2):
            args = (args[0], None, *args[1:])
        for name in kwargs:
            if not takes_any and name not in parameters and (hint := instead_of(name)):
                raise ArgumentError(f"{function.__name__} has no {name}: {hint}")
        return function(*args, **kwargs)

    return cast(Function, shifted)


def _pymeshlab_arrays(mesh: Any) -> tuple[Any, Any]:
    if not mesh.is_compact():
        raise ArrayError("the mesh has deleted elements: call its compact() first")
    return mesh.vertex_matrix(), mesh.face_matrix()


def _pymeshlab_data(mesh: Any) -> dict[str, Any]:
    selected = mesh.vertex_selection_array().copy()
    selected[mesh.face_matrix()[mesh.face_selection_array()]] = True
    data: dict[str, Any] = {"selection": selected}
    if mesh.has_vertex_scalar():
        data["quality"] = mesh.vertex_scalar_array()
    if mesh.has_vertex_color():
        data["color"] = mesh.vertex_color_matrix()
    return data


def _is_pair(mesh: Any) -> bool:
    return isinstance(mesh, tuple) and len(mesh) == 2 and np.ndim(mesh[0]) == 2


def _as_before(X: Array, points: Any) -> NDArray[Any]:
    """Return coordinates in the floating-point type of `points`."""
    dtype = np.asarray(points).dtype
    return X.astype(dtype) if np.issubdtype(dtype, np.floating) else X


def _pyvista_arrays(mesh: Any) -> tuple[Any, Any]:
    if not mesh.is_all_triangles:
        if mesh.n_cells == mesh.n_verts + mesh.n_lines:
            raise ArrayError("the mesh has no faces: reconstruct a surface first")
        raise ArrayError("the mesh has faces that are not triangles: call its triangulate() first")
    return mesh.points, mesh.regular_faces


_VTK_TRIANGLE = 5


def _grid_arrays(mesh: Any) -> tuple[Any, Any]:
    if set(np.unique(mesh.celltypes).tolist()) != {_VTK_TRIANGLE}:
        raise ArrayError(
            "the grid has cells that are not triangles: pass its surface, "
            "extract_surface().triangulate()"
        )
    return mesh.points, mesh.cells_dict[_VTK_TRIANGLE]


def _vtk_moved(mesh: Any, X: Array) -> Any:
    V, F = (_pyvista_arrays if hasattr(mesh, "regular_faces") else _grid_arrays)(mesh)
    moved = mesh.copy()
    moved.points = _as_before(X, V)
    for data, at in ((moved.point_data, "vertices"), (moved.cell_data, "faces")):
        known = [data.active_normals_name] if data.active_normals_name else []
        arrays = {name: data[name] for name in data.keys()}  # noqa: SIM118  it is no dict
        for name, values in followed(arrays, F, np.asarray(V), X, at=at, normals=known).items():
            data[name][:] = values
    return moved


def _meshio_arrays(mesh: Any) -> tuple[Any, Any]:
    surfaces = sorted(set(mesh.cells_dict) - {"vertex", "line"})
    if surfaces != ["triangle"]:
        raise ArrayError(
            f"the mesh has cells {', '.join(surfaces) or 'of no surface'}: pass a mesh of "
            "triangles only, such as "
            "pyvista.from_meshio(mesh).extract_surface().triangulate()"
        )
    return mesh.points, mesh.cells_dict["triangle"]


def _meshio_moved(mesh: Any, X: Array) -> Any:
    V, F = _meshio_arrays(mesh)
    moved = copy.deepcopy(mesh)
    moved.points = _as_before(X, V)
    moved.point_data.update(followed(mesh.point_data, F, np.asarray(V), X, at="vertices"))
    for number, block in enumerate(mesh.cells):
        if block.type != "triangle":
            continue
        arrays = {name: blocks[number] for name, blocks in mesh.cell_data.items()}
        for name, values in followed(arrays, block.data, np.asarray(V), X, at="faces").items():
            moved.cell_data[name][number] = values
    return moved


def _open3d_arrays(mesh: Any) -> tuple[Any, Any]:
    return np.asarray(mesh.vertices), np.asarray(mesh.triangles)


def _open3d_moved(mesh: Any, X: Array) -> Any:
    V, F = _open3d_arrays(mesh)
    moved = type(mesh)(mesh)
    vectors = type(mesh.vertices)
    moved.vertices = vectors(X)
    for name, at in (("vertex_normals", "vertices"), ("triangle_normals", "faces")):
        given = {name: np.asarray(getattr(mesh, name))}
        for of, values in followed(given, F, V, X, at=at).items():
            setattr(moved, of, vectors(values))
    return moved


def _tensor_arrays(mesh: Any) -> tuple[Any, Any]:
    return mesh.vertex.positions.cpu().numpy(), mesh.triangle.indices.cpu().numpy()


def _tensor_data(attributes: Any) -> dict[str, Any]:
    return {name: values.cpu().numpy() for name, values in attributes.items()}


def _tensor_moved(mesh: Any, X: Array) -> Any:
    V, F = _tensor_arrays(mesh)
    moved = mesh.clone()
    given = mesh.vertex.positions

    def tensor(values: NDArray[Any]) -> Any:
        return type(given)(values).to(given.device)

    moved.vertex.positions = tensor(_as_before(X, V))
    for attributes, at in ((moved.vertex, "vertices"), (moved.triangle, "faces")):
        for name, values in followed(_tensor_data(attributes), F, V, X, at=at).items():
            setattr(attributes, name, tensor(values))
    return moved


_POINTS, _TRIANGLES = "NIFTI_INTENT_POINTSET", "NIFTI_INTENT_TRIANGLE"


def _gifti_arrays(image: Any) -> tuple[Any, Any]:
    surface = [image.get_arrays_from_intent(intent) for intent in (_POINTS, _TRIANGLES)]
    if [len(arrays) for arrays in surface] != [1, 1]:
        raise ArrayError("the image has no surface, or several: pass one with points and triangles")
    points, triangles = (arrays[0].data for arrays in surface)
    return points, triangles


def _gifti_data(image: Any) -> dict[str, Any]:
    V, _ = _gifti_arrays(image)
    return {
        array.meta.get("Name", str(number)): array.data
        for number, array in enumerate(image.darrays)
        if len(array.data) == len(V) and array.data is not V
    }


def _gifti_moved(image: Any, X: Array) -> Any:
    V, F = _gifti_arrays(image)
    moved = copy.deepcopy(image)
    moved.get_arrays_from_intent(_POINTS)[0].data = _as_before(X, V)
    for one in moved.darrays:
        if are_normals(one.data, len(V)):
            normals = following_normals(V.astype(float), X, F.astype(int), one.data.astype(float))
            one.data = normals.astype(one.data.dtype)
    return moved


def _trimesh_arrays(mesh: Any) -> tuple[Any, Any]:
    return mesh.vertices, mesh.faces


def _trimesh_moved(mesh: Any, X: Array) -> Any:
    V, F = (np.asarray(array) for array in _trimesh_arrays(mesh))
    moved = mesh.copy()
    moved.vertices = X  # which clears trimesh's cache
    for data, at in ((moved.vertex_attributes, "vertices"), (moved.face_attributes, "faces")):
        data.update(followed(data, F, V, X, at=at))
    return moved


def _lapy_moved(mesh: Any, X: Array) -> Any:
    moved = copy.deepcopy(mesh)
    moved.v = X
    return moved


def _pyfm_moved(mesh: Any, X: Array) -> Any:
    moved = mesh.copy()
    moved.vertices = X  # which clears what depends on them
    return moved


def _point_data(mesh: Any) -> Mapping[str, Any]:
    data: Mapping[str, Any] = mesh.point_data
    return data


PYMESHLAB = MeshKind(
    "pymeshlab.Mesh", "face_matrix", _pymeshlab_arrays, written_copy, _pymeshlab_data
)
# Recognized by `_is_pair`.
_PAIR = MeshKind("a tuple (vertices, faces)", "", lambda pair: pair, lambda pair, X: (X, pair[1]))
_KINDS = (
    PYMESHLAB,
    MeshKind("pyvista.PolyData", "regular_faces", _pyvista_arrays, _vtk_moved, _point_data),
    MeshKind("pyvista.UnstructuredGrid", "celltypes", _grid_arrays, _vtk_moved, _point_data),
    MeshKind("meshio.Mesh", "cells_dict", _meshio_arrays, _meshio_moved, _point_data),
    MeshKind(
        "open3d.geometry.TriangleMesh",
        "triangle_normals",
        _open3d_arrays,
        _open3d_moved,
        lambda mesh: {"vertex_colors": np.asarray(mesh.vertex_colors)},
    ),
    MeshKind(
        "open3d.t.geometry.TriangleMesh",
        "triangle",
        _tensor_arrays,
        _tensor_moved,
        lambda mesh: _tensor_data(mesh.vertex),
    ),
    MeshKind("lapy.TriaMesh", "tria_areas", lambda mesh: (mesh.v, mesh.t), _lapy_moved),
    MeshKind("pyFM.mesh.TriMesh", "l2_sqnorm", _trimesh_arrays, _pyfm_moved),
    MeshKind(
        "nibabel.GiftiImage", "get_arrays_from_intent", _gifti_arrays, _gifti_moved, _gifti_data
    ),
    MeshKind(
        "trimesh.Trimesh",
        "faces",
        _trimesh_arrays,
        _trimesh_moved,
        lambda mesh: mesh.vertex_attributes,
    ),
)
# By the name of a class or of one that it inherits from.
_REMEDIES = {
    "MultiBlock": "pass one block, or all as one: combine().extract_surface().triangulate()",
    "MeshSet": "pass its current_mesh(), or apply the filter as its method, see load()",
    "Scene": "pass one of its geometries, or all as one: to_mesh()",
    "PointCloud": "it has no faces: reconstruct a surface first",
    "DataSet": "pass its surface: extract_surface().triangulate()",  # of pyvista
    "str": "read the file first, e.g. with pyvista.read; or filter it with filter_files",
    "PurePath": "read the file first, e.g. with pyvista.read; or filter it with filter_files",
}
