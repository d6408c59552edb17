"""Every refusal says what is wrong and what to do, and leaves the mesh unchanged."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pymeshlab
import pytest
from helpers import FILTER, assert_same, length, mesh_set_of, percent, refusal, snapshot
from meshlab_spectral import (
    ArrayError,
    SpectralError,
    filter_colors,
    filter_mesh,
    filter_scalars,
    manifold_harmonics,
)
from meshlab_spectral.plugin.loading import FILTERS
from shapes import sphere
from shared_types import Decimated

DENOISE, ARTEFACTS = FILTERS["Spectral Denoise"], FILTERS["Spectral Artefacts"]
HARMONICS, SPECTRUM = FILTERS["Manifold Harmonics"], FILTERS["Geometry Spectrum"]

# Filter, its parameters, and words of the message; the mesh has 1,202 vertices.
REFUSED: tuple[tuple[str, dict[str, Any], str], ...] = (
    (FILTER, {"spectrum": "truncated", "basis_size": 1202}, "spectrum = full"),
    (FILTER, {"spectrum": "truncated", "basis_size": 5000}, "spectrum = full"),
    (FILTER, {"pass_gain": float("nan")}, "pass_gain"),
    (FILTER, {"steps": -1}, "steps"),
    (FILTER, {"steps": 0, "tolerance": percent(0)}, "tolerance"),
    (FILTER, {"feature_size": percent(0)}, "feature_size"),
    (FILTER, {"feature_size": length(-1.0)}, "feature_size"),
    (FILTER, {"feature_size": length(float("nan"))}, "feature_size"),
    (DENOISE, {"strength": -1.0}, "strength"),
    (ARTEFACTS, {"feature_size": percent(0)}, "feature_size"),
    (ARTEFACTS, {"feature_size": length(-1.0)}, "feature_size"),
    (ARTEFACTS, {"feature_size": length(float("nan"))}, "feature_size"),
    (HARMONICS, {"mode": -1}, "mode = -1"),
    (HARMONICS, {"mode": 20, "basis_size": 20}, "modes 0 to 19"),
    (HARMONICS, {"basis_size": 1202}, "at most 1201"),
    (HARMONICS, {"basis_size": 0}, "at least 1"),
    (HARMONICS, {"basis_size": -5, "store_basis": True}, "at least 1"),
    (HARMONICS, {"mode": 0, "basis_size": 1}, "at least 2"),
    (SPECTRUM, {"basis_size": -1}, "basis_size"),
)

# Percentages and edges in it are measured on the mesh.
SIZES_OF_THE_MESH = {"filter_type": "custom", "transfer_function": "20%:1, 6e:2"}


@pytest.mark.parametrize(("name", "parameters", "named"), REFUSED)
def test_a_refused_parameter_is_named_and_the_mesh_is_unchanged(
    name: str, parameters: dict[str, Any], named: str, decimated: Decimated
) -> None:
    mesh_set = mesh_set_of(*decimated("cow.obj", 2400))
    assert mesh_set.current_mesh().vertex_number() == 1202
    before = snapshot(mesh_set.current_mesh())
    assert named in refusal(mesh_set, name, **parameters)
    assert_same(before, snapshot(mesh_set.current_mesh()))


@pytest.mark.parametrize(
    ("name", "parameters"),
    [*((name, {}) for name in FILTERS.values()), (FILTER, SIZES_OF_THE_MESH)],
)
def test_an_empty_mesh_is_refused_and_stays_empty(name: str, parameters: dict[str, Any]) -> None:
    mesh_set = mesh_set_of([[0.0, 0.0, 0.0]], np.zeros((0, 3), dtype=np.int32))
    mesh_set.set_selection_all()
    mesh_set.meshing_remove_selected_vertices()
    assert mesh_set.current_mesh().vertex_number() == 0
    assert "empty" in refusal(mesh_set, name, **parameters)
    assert mesh_set.current_mesh().vertex_number() == 0


def test_no_mesh_at_all_is_refused() -> None:
    assert "at least one mesh" in refusal(pymeshlab.MeshSet())


@pytest.mark.parametrize("name", FILTERS.values())
def test_a_point_cloud_is_refused_with_a_way_to_a_surface(name: str, decimated: Decimated) -> None:
    V, _ = decimated("cow.obj")
    data = {"v_scalar_array": V[:, 0], "v_color_matrix": np.full((len(V), 4), 0.5)}
    mesh_set = mesh_set_of(V, np.zeros((0, 3), np.int32), **data)
    before = snapshot(mesh_set.current_mesh())
    message = refusal(mesh_set, name)
    assert "point cloud" in message
    assert "Surface Reconstruction" in message
    assert_same(before, snapshot(mesh_set.current_mesh()))


@pytest.mark.parametrize("parameters", [{}, SIZES_OF_THE_MESH], ids=["default", "custom"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_coordinates_that_are_not_numbers_are_counted_and_located(
    value: float, parameters: dict[str, Any], decimated: Decimated
) -> None:
    V, F = decimated("cow.obj")
    V = V.copy()
    V[[17, 40], 1] = value
    mesh_set = mesh_set_of(V, F)
    before = snapshot(mesh_set.current_mesh())
    message = refusal(mesh_set, **parameters)
    assert "2 vertices" in message
    assert "vertex 17" in message
    assert "Delete Selected Vertices" in message
    assert_same(before, snapshot(mesh_set.current_mesh()))


@pytest.mark.parametrize("name", FILTERS.values())
def test_coordinates_beyond_single_precision_are_refused_as_such(
    name: str, decimated: Decimated
) -> None:
    V, F = decimated("cow.obj")
    V = V.copy()
    V[17, 1] = -1e39
    mesh_set = mesh_set_of(V, F)
    before = snapshot(mesh_set.current_mesh())
    message = refusal(mesh_set, name)
    assert "vertex 17 has a coordinate of -1e+39" in message
    assert "'Per Vertex Geometric Function', x * 1e-30" in message
    assert_same(before, snapshot(mesh_set.current_mesh()))


@pytest.mark.parametrize("scale", [1e75, 1e-60])
def test_the_advice_against_numbers_beyond_single_precision_helps(
    scale: float, decimated: Decimated
) -> None:
    V, F = decimated("cow.obj")
    mesh_set = mesh_set_of(scale * V, F)
    message = refusal(mesh_set)
    assert ("has a coordinate of" if scale > 1 else "the mesh is only") in message
    assert "'Per Vertex Geometric Function'" in message
    scaled = {axis: f"{axis} * {1 / scale}" for axis in "xyz"}
    mesh_set.apply_filter("compute_coord_by_function", **scaled)
    assert mesh_set.apply_filter(FILTER, steps=1)["max_displacement"] > 0


def test_faces_without_area_are_refused_with_the_remedy_that_the_robust_laplacian_is(
    decimated: Decimated,
) -> None:
    V, F = decimated("cow.obj")
    V = V.copy()
    a, b, c = F[100]
    V[c] = (V[a] + V[b]) / 2
    mesh_set = mesh_set_of(V, F)
    before = snapshot(mesh_set.current_mesh())
    message = refusal(mesh_set, laplacian="cotangent")
    assert "no area" in message
    assert "Remeshing" in message
    assert "intrinsic delaunay" in message
    assert_same(before, snapshot(mesh_set.current_mesh()))
    assert mesh_set.apply_filter(FILTER, steps=2)["accuracy_reached"]
    assert np.isfinite(mesh_set.current_mesh().vertex_matrix()).all()


def test_a_failure_after_some_steps_leaves_the_mesh_unchanged(decimated: Decimated) -> None:
    # So strong a low-pass makes triangles collapse after some steps.
    mesh_set = mesh_set_of(*decimated("cow.obj"))
    before = snapshot(mesh_set.current_mesh())
    message = refusal(
        mesh_set,
        feature_size=percent(100),
        response="butterworth",
        order=64,
        steps=64,
        laplacian="cotangent",
    )
    assert re.search(r"step ([2-9]|\d\d) of 64", message)
    assert_same(before, snapshot(mesh_set.current_mesh()))


@pytest.mark.parametrize(
    ("parameters", "advice"),
    [
        ({"pass_gain": 0.0}, "choose pass_gain = 1"),
        ({"filter_type": "high-pass", "steps": 3}, "choose stop_gain = 1"),
    ],
)
def test_a_filter_that_leaves_nothing_is_refused_with_an_option_that_keeps_the_shape(
    parameters: dict[str, Any], advice: str
) -> None:
    tetrahedron = mesh_set_of(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    )
    message = refusal(tetrahedron, **{"basis_update": "full", "steps": 10, **parameters})
    assert "shrinks to nothing" in message
    assert advice in message


def test_parts_that_would_shrink_to_nothing_are_refused_with_advice() -> None:
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    V = np.vstack([np.add(triangle, at) for at in ([0, 0, 0], [1000, 0, 0], [0, 1000, 0])])
    message = refusal(mesh_set_of(V, np.arange(9).reshape(3, 3)), feature_size=percent(100))
    assert "shrinks to nothing" in message
    assert "choose a smaller feature_size" in message


def test_what_enlarges_percentages_is_told_where_the_filter_is_too_strong_by_it() -> None:
    V, F = sphere(2)
    message = refusal(mesh_set_of(np.vstack([V, [100, 100, 100]]), F), feature_size=percent(20))
    assert "shrinks to nothing" in message
    assert "1 vertex without faces enlarges the diagonal" in message


def test_too_large_a_gain_is_refused_as_too_steep(decimated: Decimated) -> None:
    assert refusal(mesh_set_of(*decimated("cow.obj")), pass_gain=1e30).endswith(
        "choose a smaller pass_gain"
    )


def test_the_laplacian_in_use_is_not_recommended_for_parts_destroyed_by_round_off() -> None:
    # Unit tetrahedra, two of them where neighbouring numbers differ by 16.
    places = np.vstack([1e17 * np.random.default_rng(101).uniform(size=(2, 3)), np.zeros(3)])
    V = np.vstack([np.vstack([np.zeros(3), np.eye(3)]) + place for place in places])
    F = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    message = refusal(mesh_set_of(V, np.vstack([F, F + 4, F + 8])))
    assert "intrinsic delaunay" not in message
    assert "'Remove Isolated pieces (wrt Diameter)'" in message


V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def test_complex_numbers_are_refused_rather_than_cut() -> None:
    def turned(w: Any) -> Any:
        return 1 / (1 + 1j * w)

    basis = manifold_harmonics(V, F, 2)
    calls: tuple[Callable[[], Any], ...] = (
        lambda: filter_mesh(V + 0.5j, F),
        lambda: filter_mesh(V, F, gain=turned),
        lambda: filter_mesh(V, F, gain=lambda w: turned(float(w))),
        lambda: filter_mesh(V, F, weights=[0, 1, 1j, 0]),
        lambda: filter_scalars(V, F, [0, 1, 1j, 0]),
        lambda: filter_colors(V, F, V + 0j),
        lambda: basis.filter(V[:, 0], turned),
        lambda: basis.project(V + 0j),
        lambda: basis.heat_kernel_signature([1j]),
    )
    for call in calls:
        with pytest.raises(ArrayError, match="are complex: pass real numbers"):
            call()


def test_masked_numbers_are_refused_rather_than_used() -> None:
    masked = np.ma.masked_array(V[:, 0], mask=[False, True, False, False])
    with pytest.raises(ArrayError, match=r"values are masked: .*values\.filled\(numpy\.nan\)"):
        filter_scalars(V, F, masked)
    unmasked, _ = filter_scalars(V, F, np.ma.masked_array(V[:, 0]))
    np.testing.assert_array_equal(unmasked, filter_scalars(V, F, V[:, 0])[0])


def test_arrays_of_the_wrong_shape_are_errors_of_this_package() -> None:
    for vertices, faces in ((V[:, :2], F), (V, F + 1), (V[:0], F[:0]), (V, F * 0.5), ("ab", F)):
        with pytest.raises(SpectralError) as refused:
            filter_mesh(vertices, faces)
        assert isinstance(refused.value, ValueError)
