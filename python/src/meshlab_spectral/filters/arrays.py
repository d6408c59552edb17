"""Validation of meshes and of data at their vertices; vertex areas and lengths of meshes."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral import _core
from meshlab_spectral.errors import ArgumentError, ArrayError, OptionError
from meshlab_spectral.filters.mesh_objects import array_of, kind_of, known_kinds, remedy_for
from meshlab_spectral.formats.normals import area_vectors


class Lengths(NamedTuple):
    """Lengths of a mesh that sizes and defaults refer to."""

    diagonal: float  # of the bounding box
    mean_edge: float
    surface_diagonal: float  # of the bounding box of the triangles


def mesh_arrays(
    mesh_or_vertices: Any, faces: ArrayLike | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Validate and convert the arrays of a mesh; pymeshlab would misread or reject them silently.

    These are n x 3 coordinates, and m x 3 vertex indices of triangles, from 0 to n - 1; or a mesh
    of `mesh_objects`, alone. Raises ArrayError when an array has the wrong shape or type, or an
    index is out of range, and ArgumentError when a mesh is of no known kind.
    """
    vertices = mesh_or_vertices
    kind = kind_of(mesh_or_vertices)
    if kind is not None and faces is None:
        vertices, faces = kind.arrays(mesh_or_vertices)
    elif faces is None:
        if (remedy := remedy_for(mesh_or_vertices)) is not None:
            raise ArgumentError(f"{_class_of(mesh_or_vertices)} is not a mesh: {remedy}")
        raise ArgumentError(
            f"there are no faces with {_class_of(mesh_or_vertices)}: pass vertices and faces, or a "
            f"mesh: {known_kinds()}"
        )
    elif kind is not None:
        raise ArgumentError(f"faces: {kind.name} has its own; pass the mesh alone, or two arrays")
    V, F = real_numbers(vertices, "vertices"), _faces_array(faces)
    if V.ndim != 2 or V.shape[1] != 3:
        raise ArrayError(f"vertices have shape {V.shape}: pass n x 3 coordinates")
    if len(V) == 0:
        raise ArrayError("there are no vertices: pass a mesh")
    if F.ndim == 2 and F.shape[1] == 4 and np.issubdtype(F.dtype, np.integer):
        raise ArrayError(
            f"faces have shape {F.shape}: pass triangles; quadrangles are split by "
            "numpy.vstack([faces[:, :3], faces[:, [0, 2, 3]]])"
        )
    if F.ndim != 2 or F.shape[1] != 3 or not np.issubdtype(F.dtype, np.integer):
        raise ArrayError(
            f"faces have shape {F.shape} and type {F.dtype}: pass m x 3 integers, the corners of "
            "triangles"
        )
    if F.size and (F.min() < 0 or F.max() >= len(V)):
        wrong = F.min() if F.min() < 0 else F.max()
        raise ArrayError(f"a face refers to vertex {wrong}, but there are {len(V)} vertices")
    return V, F.astype(np.int32, copy=False)


def real_numbers(values: Any, name: str) -> NDArray[np.float64]:
    """Return values as an array; raise ArrayError for complex or masked ones, or no numbers."""
    if np.ma.is_masked(values):
        raise ArrayError(f"{name} are masked: pass a plain array, such as {name}.filled(numpy.nan)")
    try:
        array = np.asarray(values)
        if not np.iscomplexobj(array):
            return array.astype(np.float64, copy=False)
    except (ValueError, TypeError) as error:
        raise ArrayError(f"{name} are not an array of numbers: {error}") from error
    raise ArrayError(f"{name} are complex: pass real numbers")


def _faces_array(faces: Any) -> NDArray[Any]:
    try:
        return np.asarray(faces)
    except ValueError as error:  # rows of several lengths
        raise ArrayError(
            "faces have several numbers of corners: split them into triangles first"
        ) from error


def _class_of(mesh: Any) -> str:
    library = type(mesh).__module__.partition(".")[0]
    name = type(mesh).__name__
    return name if library == "builtins" else f"{library}'s {name}"


def vertex_numbers(values: ArrayLike, count: int, name: str) -> NDArray[np.float64]:
    """Return one number for each of `count` vertices; raise ArrayError unless there are as many."""
    numbers = real_numbers(values, name)
    if numbers.shape != (count,):
        raise ArrayError(
            f"{name} have shape {numbers.shape}: pass {count} numbers, one for each vertex"
        )
    return numbers


def selected_vertices(
    mesh: Any,
    selection: ArrayLike | None,
    count: int,
    F: NDArray[np.integer],
    parameters: dict[str, Any],
) -> NDArray[np.bool_] | None:
    """Return which of `count` vertices are selected, and say so in the parameters of the filter.

    `selection` is one boolean per vertex, or indices of faces in `F`, m x 3, which select their
    corners, or the name of such data of the mesh. Raises ArrayError when it is none, or an index is
    out of range; OptionError when it is missing.
    """
    if selection is None:
        if parameters.get("selected"):
            raise OptionError("selected = True: pass the selected vertices or faces as selection")
        return None
    parameters["selected"] = True
    return _chosen(array_of(mesh, selection, "selection"), count, F)


def _chosen(selection: ArrayLike, count: int, F: NDArray[np.integer]) -> NDArray[np.bool_]:
    array = np.asarray(selection)
    if array.dtype == bool and array.shape == (count,):
        return array
    if array.shape == (count,) and count > 2 and set(np.unique(array)) <= {0, 1}:
        raise ArrayError(
            f"selection has a 0 or 1 for each of {count} vertices: pass booleans, such as "
            "selection.astype(bool)"
        )
    chosen = np.zeros(count, dtype=bool)
    if array.size == 0:
        return chosen
    if array.ndim != 1 or not np.issubdtype(array.dtype, np.integer):
        raise ArrayError(
            f"selection has shape {array.shape} and type {array.dtype}: pass {count} booleans, one "
            "for each vertex, or indices of faces (of a mask: numpy.flatnonzero(mask))"
        )
    if array.min() < 0 or array.max() >= len(F):
        wrong = array.min() if array.min() < 0 else array.max()
        raise ArrayError(f"selection has face {wrong}, but there are {len(F)} faces")
    chosen[F[array]] = True
    return chosen


def check_class(value: Any, expected: type[Any], source: str) -> None:
    """Raise ArgumentError unless a value is of a class, as the function `source` returns it."""
    if not isinstance(value, expected):
        raise ArgumentError(
            f"{_class_of(value)} is not a {expected.__name__}: pass the result of {source}"
        )


def lumped_areas(V: NDArray[np.float64], F: NDArray[np.integer]) -> NDArray[np.float64]:
    """Return the n vertex areas, each a third of its triangles' area: the diagonal of D."""
    areas = np.linalg.norm(area_vectors(V, F), axis=1)
    lumped = np.zeros(len(V))
    np.add.at(lumped, F, areas[:, None] / 3)
    return lumped


def lengths_of(V: NDArray[np.floating], F: NDArray[np.integer]) -> Lengths:
    """Return the lengths of a mesh with triangles, as filters measure them."""
    corners = np.ascontiguousarray(F, dtype=np.int32)
    return Lengths(*_core.lengths(np.ascontiguousarray(V, dtype=np.float64), corners))


def mean_edge(V: NDArray[np.floating], F: NDArray[np.integer]) -> float:
    """Return the mean side length over all triangles; 0 without triangles."""
    return lengths_of(V, F).mean_edge
