"""What several tests need: calling the filter, catching its refusals, comparing meshes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
from meshlab_spectral._core import filters
from meshlab_spectral.files.filtering import filter_to_scratch
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.whole_files import writing_whole
from meshlab_spectral.filters.option_types import Options
from numpy.typing import NDArray

FILTER = "apply_coord_spectral_filter_fractional"

_refusing_mesh_sets: list[pymeshlab.MeshSet] = []


def mesh_set_of(V: NDArray[Any], F: NDArray[Any], **data: Any) -> pymeshlab.MeshSet:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.add_mesh(pymeshlab.Mesh(V, F, **data))
    return mesh_set


def loaded(path: Path) -> pymeshlab.MeshSet:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(path))
    return mesh_set


def decorated(V: NDArray[Any], F: NDArray[Any]) -> pymeshlab.MeshSet:
    """Make a mesh with one of every attribute that pymeshlab shows."""
    rng = np.random.default_rng(1)
    n, m = len(V), len(F)
    mesh = pymeshlab.Mesh(
        V,
        F,
        v_scalar_array=rng.random(n),
        f_scalar_array=rng.random(m),
        v_color_matrix=rng.random((n, 4)),
        f_color_matrix=rng.random((m, 4)),
        v_tex_coords_matrix=rng.random((n, 2)),
        w_tex_coords_matrix=rng.random((3 * m, 2)),
    )
    mesh_set = pymeshlab.MeshSet()
    mesh_set.add_mesh(mesh)
    mesh = mesh_set.current_mesh()
    mesh.add_vertex_custom_scalar_attribute(rng.random(n), "age")
    mesh.add_vertex_custom_point_attribute(rng.random((n, 3)), "wind")
    mesh.add_face_custom_scalar_attribute(rng.random(m), "part")
    mesh.add_face_custom_point_attribute(rng.random((m, 3)), "grain")
    mesh_set.compute_selection_by_condition_per_vertex(condselect="(x > 0)")
    mesh_set.compute_selection_by_condition_per_face(condselect="(y0 > 0)")
    return mesh_set


def custom_attributes(mesh: pymeshlab.Mesh) -> dict[str, NDArray[Any]]:
    """The custom attributes of a decorated mesh, by name."""
    arrays = {
        "age": mesh.vertex_custom_scalar_attribute_array("age"),
        "wind": mesh.vertex_custom_point_attribute_matrix("wind"),
        "part": mesh.face_custom_scalar_attribute_array("part"),
        "grain": mesh.face_custom_point_attribute_matrix("grain"),
    }
    return {name: np.array(array) for name, array in arrays.items()}


def filter_arrays(
    V: NDArray[Any], F: NDArray[Any], **parameters: Any
) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """Filter a mesh from arrays; the new coordinates and the report."""
    mesh_set = mesh_set_of(V, F)
    report = mesh_set.apply_filter(FILTER, **parameters)
    return mesh_set.current_mesh().vertex_matrix().copy(), report


def filter_file(
    source: Path, target: Path, options: Options, mesh: str | None = None
) -> dict[str, Any]:
    """Filter a mesh file into another, and return the report."""
    with writing_whole(target) as scratch:
        return filter_to_scratch(Request(source, options, mesh), scratch, lambda *stage: None)


def refusal(mesh_set: pymeshlab.MeshSet, filter_name: str = FILTER, **parameters: Any) -> str:
    """Call a filter, which must refuse; its message."""
    # pymeshlab 2025.7 crashes when a MeshSet is destroyed in which a filter, any filter, has
    # failed: such a MeshSet lives until the end of the tests.
    _refusing_mesh_sets.append(mesh_set)
    with pytest.raises(pymeshlab.PyMeshLabException) as error:
        mesh_set.apply_filter(filter_name, **parameters)
    return str(error.value)


def lower_part(V: NDArray[Any], F: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Cut a mesh at half of its height, z: a surface with a boundary."""
    below = V[:, 2] < np.median(V[:, 2])
    used, index = np.unique(F[below[F].all(axis=1)], return_inverse=True)
    return V[used], index.reshape(-1, 3)


def other_options(**chosen: Any) -> dict[str, Any]:
    """Return a value other than the default for every option of the filter, most by its kind.

    A bare mesh has no selection and no quality, and details would be no shape to compare: these
    three options keep their defaults.
    """
    chosen = {
        "filter_type": "band-pass",
        "transfer_function": "10%:1, 5%:0.5",
        "steps": 2,
        "selected": False,
        "weight": "none",
        "result": "filtered shape",
        **chosen,
    }
    (contract,) = (one for one in filters() if one["python_name"] == FILTER)
    return {
        one["name"]: chosen[one["name"]] if one["name"] in chosen else _other_value(one)
        for one in contract["parameters"]
    }


def _other_value(parameter: dict[str, Any]) -> Any:
    default = parameter["default"]
    match parameter["kind"]:
        case "bool":
            return not default
        case "choice":
            return parameter["choices"][int(default == 0)]
        case "length":
            return "1%"
        case "int":
            return default + 1
    return 0.5


def as_percentages(options: dict[str, Any]) -> dict[str, Any]:
    """Turn options that are percentages into pymeshlab's type."""
    return {
        name: percent(float(value[:-1])) if str(value).endswith("%") else value
        for name, value in options.items()
    }


def percent(value: float) -> pymeshlab.PercentageValue:
    return pymeshlab.PercentageValue(value)


def length(value: float) -> pymeshlab.PureValue:
    return pymeshlab.PureValue(value)


def diagonal(V: NDArray[Any]) -> float:
    return float(np.linalg.norm(np.ptp(V, axis=0)))


def largest_distance(A: NDArray[Any], B: NDArray[Any]) -> float:
    """Largest distance between vertices of the same number."""
    return float(np.linalg.norm(A - B, axis=1).max())


def snapshot(mesh: pymeshlab.Mesh) -> dict[str, NDArray[Any]]:
    """Everything of a mesh that pymeshlab shows as arrays, by name."""
    arrays = {
        name: getattr(mesh, name)()
        for name in (
            "vertex_matrix",
            "face_matrix",
            "vertex_normal_matrix",
            "face_normal_matrix",
            "vertex_selection_array",
            "face_selection_array",
        )
    }
    for present, name in {
        "has_vertex_color": "vertex_color_matrix",
        "has_face_color": "face_color_matrix",
        "has_vertex_scalar": "vertex_scalar_array",
        "has_face_scalar": "face_scalar_array",
        "has_vertex_tex_coord": "vertex_tex_coord_matrix",
        "has_wedge_tex_coord": "wedge_tex_coord_matrix",
    }.items():
        if getattr(mesh, present)():
            arrays[name] = getattr(mesh, name)()
    return {name: np.array(array) for name, array in arrays.items()}


def assert_same(before: dict[str, NDArray[Any]], after: dict[str, NDArray[Any]]) -> None:
    """Assert bitwise equality; NaN equals NaN."""
    assert before.keys() == after.keys()
    for name, array in before.items():
        np.testing.assert_array_equal(array, after[name], err_msg=name)
