"""Vertices that no face uses change no default; a warning says where they change percentages."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
from commands import arrays_of, succeeded
from helpers import diagonal, mesh_set_of, percent
from meshlab_spectral import (
    denoise_mesh,
    filter_colors,
    filter_mesh,
    filter_scalars,
    geometry_spectrum,
    measure_artefacts,
)
from meshlab_spectral.plugin.library import last_warnings
from meshlab_spectral.plugin.loading import FILTERS
from numpy.typing import NDArray
from shared_types import Decimated

Array = NDArray[Any]
Shape = tuple[Array, Array]

ENLARGING = "the diagonal of the bounding box from"
REMEDY = "Remove them first"
WITHOUT_PERCENTAGES = "compute_scalar_manifold_harmonic_per_vertex"


@pytest.fixture
def shape(decimated: Decimated) -> Shape:
    """A bunny with noise that Spectral Denoise finds."""
    V, F = decimated("bunny.obj", 8000)
    noise = np.random.default_rng(1).standard_normal(V.shape)
    return V + 4e-3 * diagonal(V) * noise, F


def with_unused(V: Array, *positions: float) -> Array:
    """Add vertices that no face uses, at multiples of the diagonal from the mesh along x."""
    unused = V.max(axis=0) + diagonal(V) * np.outer(positions, [1.0, 0.0, 0.0])
    return np.vstack([V, unused])


def prepared(V: Array, F: Array) -> pymeshlab.MeshSet:
    """A MeshSet whose mesh has a quality and colours, the same at the vertices that faces use."""
    colors = np.ones((len(V), 4))
    colors[:, :3] = 0.5 + 0.4 * np.sin(9 * V)
    mesh_set = pymeshlab.MeshSet()
    quality = V[:, 0] + V[:, 1] * V[:, 2]
    mesh_set.add_mesh(pymeshlab.Mesh(V, F, v_scalar_array=quality, v_color_matrix=colors))
    return mesh_set


def written(mesh: pymeshlab.Mesh, n: int) -> list[Array]:
    """All that a filter may have written, at the first n vertices."""
    arrays = mesh.vertex_matrix(), mesh.vertex_scalar_array(), mesh.vertex_color_matrix()
    return [np.array(array)[:n] for array in arrays]


def assert_same_report(one: dict[str, Any], other: dict[str, Any]) -> None:
    changing = {"unreferenced_vertices", "diagonal", "clamped_values"}
    changing |= {"warnings", "warning_codes"}
    assert one.keys() == other.keys()
    for name in one.keys() - changing:
        np.testing.assert_array_equal(one[name], other[name], err_msg=name)


@pytest.mark.parametrize("name", FILTERS.values())
def test_no_default_of_a_filter_depends_on_them(name: str, shape: Shape) -> None:
    V, F = shape
    usual, far = prepared(V, F), prepared(with_unused(V, 5, 7), F)
    parameters = usual.filter_parameter_values(name)
    assert far.filter_parameter_values(name) == parameters
    # The shape is so coarse that it is all creases.
    given = {"crease_angle": 180.0} if name.startswith("compute_scalar_surface") else {}
    reports = [mesh_set.apply_filter(name, **given) for mesh_set in (usual, far)]
    assert_same_report(*reports)
    results = [written(mesh_set.current_mesh(), len(V)) for mesh_set in (usual, far)]
    for one, other in zip(*results, strict=True):
        np.testing.assert_array_equal(one, other)
    enlarging = [warning for warning in last_warnings() if ENLARGING in warning]
    assert len(enlarging) == (name != WITHOUT_PERCENTAGES)


CALLS: dict[str, Callable[[Array, Array], Any]] = {
    "filter_mesh": filter_mesh,
    "gain": lambda V, F: filter_mesh(V, F, gain=lambda w: 1 / (1 + w**4)),
    "denoise_mesh": denoise_mesh,
    "filter_scalars": lambda V, F: filter_scalars(V, F, V[:, 0]),
    "filter_colors": lambda V, F: filter_colors(V, F, np.clip(V[:, [0, 1, 2]], 0, 1)),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_no_default_of_a_function_depends_on_them(
    call: Callable[[Array, Array], Any], shape: Shape
) -> None:
    V, F = shape
    usual, report = call(V, F)
    far, same = call(with_unused(V, 5), F)
    np.testing.assert_array_equal(far[: len(V)], usual)
    assert_same_report(report, same)
    assert not any(ENLARGING in warning for warning in report["warnings"])
    assert sum(ENLARGING in warning for warning in same["warnings"]) == 1


def test_the_spectrum_of_a_shape_does_not_depend_on_them(shape: Shape) -> None:
    V, F = shape
    usual, far = geometry_spectrum(V, F), geometry_spectrum(with_unused(V, 5), F)
    assert far.diagonal > 5 * usual.diagonal
    assert far.default_feature_size == usual.default_feature_size
    for name in ("octave_feature_sizes", "octave_amplitudes", "band_amplitudes", "noise_height"):
        np.testing.assert_array_equal(getattr(far, name), getattr(usual, name))
    size = usual.default_feature_size
    one, other = (measure_artefacts(W, F, size) for W in (V, with_unused(V, 5)))
    np.testing.assert_array_equal(other.length[: len(V)], one.length)


def test_a_given_percentage_refers_to_all_vertices_and_a_warning_says_so(shape: Shape) -> None:
    V, F = shape
    far = with_unused(V, 5, 7)
    mesh_set = mesh_set_of(far, F)
    by_meshlab = mesh_set.apply_coord_spectral_filter_fractional(feature_size=percent(2))
    box = mesh_set.current_mesh().bounding_box()
    _, report = filter_mesh(far, F, feature_size="2%")
    assert report["feature_size"] == by_meshlab["feature_size"]
    assert report["feature_size"] == pytest.approx(0.02 * diagonal(far), rel=1e-6)
    assert report["feature_size"] == pytest.approx(0.02 * box.diagonal(), rel=1e-2)
    (enlarging,) = (warning for warning in report["warnings"] if ENLARGING in warning)
    numbers = (
        f"2 vertices without faces enlarge {ENLARGING} {diagonal(V):.3g} to {diagonal(far):.3g}"
    )
    assert enlarging.startswith(numbers)
    assert "percentages refer to the larger one" in enlarging
    assert REMEDY in enlarging
    mesh_set = mesh_set_of(far, F)
    mesh_set.meshing_remove_unreferenced_vertices()
    assert mesh_set.apply_coord_spectral_filter_fractional()
    assert not any(ENLARGING in warning for warning in last_warnings())


def test_custom_gains_in_percent_have_the_same_diagonal(shape: Shape) -> None:
    V, F = shape
    far = with_unused(V, 5)
    _, report = filter_mesh(far, F, filter_type="custom", transfer_function="4%:1, 1%:0")
    assert report["feature_size"] == pytest.approx(0.02 * diagonal(far), rel=1e-6)
    _, report = filter_mesh(far, F, feature_size="2%", gain=lambda w: 1 / (1 + w**4))
    assert report["feature_size"] == pytest.approx(0.02 * diagonal(far), rel=1e-6)


@pytest.mark.parametrize(("beyond", "count"), [(0.005, 0), (0.05, 1)])
def test_one_percent_of_the_diagonal_is_not_worth_a_warning(beyond: float, count: int) -> None:
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1e-3, 0], [0.5, 0, 1e-3]])
    F = np.array([[0, 1, 2], [0, 1, 3]])
    _, report = filter_mesh(with_unused(V, beyond), F, stop_gain=1.0)
    enlarging = [warning for warning in report["warnings"] if "without faces" in warning]
    assert len(enlarging) == count
    assert all(warning.startswith("1 vertex without faces enlarges") for warning in enlarging)


def test_vertices_left_by_deleted_faces_are_unused(shape: Shape) -> None:
    """Deletion and filter run as one script, so that pymeshlab compacts nothing in between."""
    V, F = shape
    far = with_unused(V, 5, 6, 7)
    mesh_set = mesh_set_of(far, np.vstack([F, [[len(V), len(V) + 1, len(V) + 2]]]))
    mesh_set.compute_selection_by_condition_per_face(condselect=f"fi == {len(F)}")
    mesh_set.meshing_remove_selected_faces()
    report = mesh_set.apply_coord_spectral_filter_fractional()
    enlarging = f"3 vertices without faces enlarge {ENLARGING}"
    assert any(enlarging in warning for warning in last_warnings())
    expected = mesh_set_of(V, F).apply_coord_spectral_filter_fractional()
    assert_same_report(report, expected)


@pytest.mark.parametrize("name", ["filter", "denoise"])
def test_no_default_of_a_command_depends_on_them(name: str, shape: Shape, tmp_path: Path) -> None:
    V, F = shape
    results = []
    for number, W in enumerate((V, with_unused(V, 5))):
        source, target = tmp_path / f"{number}.ply", tmp_path / f"{number}_out.ply"
        mesh_set_of(W, F).save_current_mesh(str(source))
        done = succeeded(name, source, target)
        assert (ENLARGING in done.stderr) == (number == 1)
        results.append(arrays_of(target)[0][: len(V)])
    assert not np.array_equal(results[0], V)
    np.testing.assert_array_equal(*results)


def test_the_command_info_suggests_the_same_size_and_warns(shape: Shape, tmp_path: Path) -> None:
    V, F = shape
    source = tmp_path / "far.ply"
    mesh_set_of(with_unused(V, 5), F).save_current_mesh(str(source))
    done = succeeded("info", source)
    assert "1 vertex without faces enlarges" in done.stdout + done.stderr
