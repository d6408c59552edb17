"""Selections, weights, creases and volumes, as passed by users of pymeshlab."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
from helpers import (
    FILTER,
    assert_same,
    custom_attributes,
    decorated,
    diagonal,
    filter_arrays,
    loaded,
    mesh_set_of,
    percent,
    refusal,
    snapshot,
)
from meshlab_spectral import filter_mesh
from meshlab_spectral.plugin.library import last_warnings
from numpy.typing import NDArray
from shared_types import Decimated, SharedMesh

SIZE = {"feature_size": percent(6), "steps": 2}


@pytest.fixture
def small(decimated: Decimated) -> tuple[NDArray[Any], NDArray[Any]]:
    return decimated("cow.obj", 2400)


def head_of(V: NDArray[Any]) -> str:
    """Return a condition on x that the front third of the mesh meets."""
    return f"{np.quantile(V[:, 0], 2 / 3)}"


def test_a_selection_is_filtered_by_default_and_all_else_is_left_bit_for_bit_unchanged(
    small: tuple[NDArray[Any], NDArray[Any]],
) -> None:
    V, F = small
    whole, _ = filter_arrays(V, F, **SIZE)
    mesh_set = mesh_set_of(V, F)
    cut = head_of(V)
    mesh_set.compute_selection_by_condition_per_face(
        condselect=f"(x0 > {cut}) && (x1 > {cut}) && (x2 > {cut})"
    )
    faces = mesh_set.current_mesh().face_selection_array()
    mesh_set.apply_filter(FILTER, **SIZE)
    part = mesh_set.current_mesh().vertex_matrix()
    selected = np.zeros(len(V), dtype=bool)
    selected[F[faces]] = True
    np.testing.assert_allclose(part[selected], whole[selected], atol=1e-14 * diagonal(V))
    distance = np.linalg.norm(V[:, None] - V[selected][None], axis=2).min(axis=1)
    beyond = distance > 1.25 * 0.06 * diagonal(V)  # on a coarse mesh it falls more slowly
    assert np.count_nonzero(beyond) > 300
    np.testing.assert_array_equal(part[beyond], V[beyond])
    around = ~selected & np.any(part != V, axis=1)
    assert np.count_nonzero(around) > 10
    assert np.array_equal(faces, mesh_set.current_mesh().face_selection_array())


def bends(V: NDArray[Any], F: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Edges with two faces, as pairs of vertices, and the angles of these faces' normals."""
    sides = np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort(sides.T)
    first = np.flatnonzero(np.all(sides[order[1:]] == sides[order[:-1]], axis=1))
    a, b = order[first] // 3, order[first + 1] // 3
    N = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    N /= np.linalg.norm(N, axis=1, keepdims=True)
    cosines = np.clip(np.sum(N[a] * N[b], axis=1), -1, 1)
    return sides[order[first]], np.degrees(np.arccos(cosines))


@pytest.mark.parametrize("name", ["igea.ply", "stanford-bunny.obj"])
def test_no_crease_appears_at_the_border_of_a_selection(name: str, shared_mesh: SharedMesh) -> None:
    mesh_set = loaded(shared_mesh(name))
    mesh = mesh_set.current_mesh()
    V, F = mesh.vertex_matrix().copy(), mesh.face_matrix()
    size = {"feature_size": percent(7)}
    whole, _ = filter_arrays(V, F, **size)
    head = np.quantile(V[:, 1], 0.7)
    mesh_set.compute_selection_by_condition_per_face(condselect=f"y0 > {head} && y1 > {head}")
    selected = np.zeros(len(V), dtype=bool)
    selected[F[mesh.face_selection_array()]] = True
    mesh_set.apply_filter(FILTER, **size)
    part = mesh.vertex_matrix()
    edges, before = bends(V, F)
    (_, of_part), (_, of_whole) = bends(part, F), bends(whole, F)
    border = selected[edges[:, 0]] != selected[edges[:, 1]]
    assert of_part[border].mean() <= of_whole[border].mean() < 0.6 * before[border].mean()
    assert np.quantile(of_part[border], 0.99) <= 1.1 * np.quantile(of_whole[border], 0.99)
    around = (np.any(part != V, axis=1) & ~selected)[edges].any(axis=1)
    assert of_part[around].mean() < before[around].mean()
    assert np.quantile(of_part[around], 0.99) < np.quantile(before[around], 0.99)


def test_selected_vertices_are_a_selection_too(small: tuple[NDArray[Any], NDArray[Any]]) -> None:
    V, F = small
    mesh_set = mesh_set_of(V, F)
    mesh_set.compute_selection_by_condition_per_vertex(condselect=f"x > {head_of(V)}")
    vertices = mesh_set.current_mesh().vertex_selection_array()
    mesh_set.apply_filter(FILTER, selected=True, **SIZE)
    moved = np.any(mesh_set.current_mesh().vertex_matrix() != V, axis=1)
    assert np.all(moved[vertices])
    assert not np.all(moved)


@pytest.mark.parametrize(
    "name",
    [
        FILTER,
        "apply_scalar_spectral_filter_per_vertex",
        "apply_coord_spectral_denoise",
        "apply_coord_spectral_equalizer",
    ],
)
def test_a_selection_left_by_another_filter_is_reported(name: str) -> None:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.create_sphere(subdiv=3)
    mesh_set.compute_scalar_by_function_per_vertex(q="x")
    mesh_set.compute_selection_by_condition_per_face(condselect="z0 > 0.9")
    mesh_set.meshing_remove_selected_faces()
    mesh_set.meshing_remove_unreferenced_vertices()
    mesh_set.meshing_close_holes()
    mesh = mesh_set.current_mesh()
    F = mesh.face_matrix()
    count = len(np.unique(F[mesh.face_selection_array()]))
    assert 0 < count < mesh.vertex_number()
    report = mesh_set.apply_filter(name)
    words = [*last_warnings(), report.get("summary", "")]
    message = f"only the selection: {count} of {mesh.vertex_number()} vertices"
    assert any(message in text for text in words)


def test_a_selection_is_ignored_on_request(small: tuple[NDArray[Any], NDArray[Any]]) -> None:
    V, F = small
    whole, _ = filter_arrays(V, F, **SIZE)
    mesh_set = mesh_set_of(V, F)
    mesh_set.set_selection_all()
    mesh_set.apply_filter(FILTER, selected=False, **SIZE)
    np.testing.assert_array_equal(mesh_set.current_mesh().vertex_matrix(), whole)


def test_an_empty_selection_is_refused(small: tuple[NDArray[Any], NDArray[Any]]) -> None:
    mesh_set = mesh_set_of(*small)
    before = snapshot(mesh_set.current_mesh())
    assert "nothing is selected" in refusal(mesh_set, selected=True)
    assert_same(before, snapshot(mesh_set.current_mesh()))


def weighted(small: tuple[NDArray[Any], NDArray[Any]], quality: Any) -> pymeshlab.MeshSet:
    V, F = small
    return mesh_set_of(V, F, v_scalar_array=np.broadcast_to(quality, len(V)).astype(float))


def test_quality_weights_the_filter_at_every_vertex(
    small: tuple[NDArray[Any], NDArray[Any]],
) -> None:
    V, F = small
    whole, _ = filter_arrays(V, F, **SIZE)
    for quality in (0.0, 1.0, np.linspace(0, 1, len(V))):
        mesh_set = weighted(small, quality)
        mesh_set.apply_filter(FILTER, weight="vertex quality", **SIZE)
        mesh = mesh_set.current_mesh()
        expected = V + np.broadcast_to(quality, len(V))[:, None] * (whole - V)
        np.testing.assert_allclose(mesh.vertex_matrix(), expected, atol=1e-14 * diagonal(V))
        np.testing.assert_array_equal(mesh.vertex_scalar_array(), np.broadcast_to(quality, len(V)))


@pytest.mark.parametrize("quality", [-0.5, 1.5, np.nan])
def test_a_quality_that_is_not_a_weight_is_refused(
    small: tuple[NDArray[Any], NDArray[Any]], quality: float
) -> None:
    qualities = np.full(len(small[0]), 0.5)
    qualities[7] = quality
    message = refusal(weighted(small, qualities), weight="vertex quality", **SIZE)
    assert "vertex 7" in message
    assert "between 0" in message


def test_a_mesh_without_quality_has_no_weights(cow: Path) -> None:
    mesh_set = loaded(cow)
    assert "no vertex quality" in refusal(mesh_set, weight="vertex quality", **SIZE)


def test_details_are_what_the_filter_takes_away_and_the_shape_stays(
    small: tuple[NDArray[Any], NDArray[Any]],
) -> None:
    V, F = small
    filtered, report = filter_arrays(V, F, **SIZE)
    mesh_set = decorated(V, F)
    mesh = mesh_set.current_mesh()
    before, custom = snapshot(mesh), custom_attributes(mesh)
    for _ in range(2):  # the second run replaces the details of the first
        again = mesh_set.apply_filter(FILTER, result="details", selected=False, **SIZE)
    assert again["max_displacement"] == report["max_displacement"]
    after = snapshot(mesh)
    details = mesh.vertex_custom_point_attribute_matrix("spectral_details")
    np.testing.assert_array_equal(details, V - filtered)
    N = before["vertex_normal_matrix"]
    N = N / np.linalg.norm(N, axis=1, keepdims=True)
    outward = after.pop("vertex_scalar_array")
    np.testing.assert_allclose(outward, np.sum(details * N, axis=1), atol=1e-15 * diagonal(V))
    assert outward.min() < 0 < outward.max()
    kept = mesh.vertex_custom_scalar_attribute_array("quality_before")
    np.testing.assert_array_equal(kept, before.pop("vertex_scalar_array"))
    kept = mesh.vertex_custom_point_attribute_matrix("color_before")
    levels = np.round(255 * before.pop("vertex_color_matrix")[:, :3])
    np.testing.assert_array_equal(kept, levels)
    assert len(np.unique(after.pop("vertex_color_matrix"), axis=0)) > 100
    assert_same(before, after)
    assert_same(custom, custom_attributes(mesh))
    taken, _ = filter_mesh(V, F, result="details", feature_size="6%", steps=2)
    np.testing.assert_array_equal(taken, details)


def test_bumps_are_positive_details_and_details_scale_with_weights(
    small: tuple[NDArray[Any], NDArray[Any]],
) -> None:
    V, F = small
    whole, _ = filter_mesh(V, F, result="details", feature_size="6%", steps=2)
    mesh_set = weighted(small, 0.25)
    options = {"weight": "vertex quality", "result": "details"}
    mesh_set.apply_filter(FILTER, **options, **SIZE)
    mesh = mesh_set.current_mesh()
    found = mesh.vertex_custom_point_attribute_matrix("spectral_details")
    np.testing.assert_allclose(found, whole / 4, atol=1e-14 * diagonal(V))
    mesh_set = pymeshlab.MeshSet()
    mesh_set.create_sphere(radius=1, subdiv=3)  # a low-pass shrinks it
    mesh_set.apply_filter(FILTER, result="details", feature_size=percent(60), steps=1)
    assert mesh_set.current_mesh().vertex_scalar_array().min() > 0


def test_there_are_no_details_where_nothing_moves(samples: Path) -> None:
    mesh_set = loaded(samples / "bone.ply")  # with vertices without faces
    mesh = mesh_set.current_mesh()
    lonely = np.setdiff1d(np.arange(mesh.vertex_number()), mesh.face_matrix())
    mesh_set.apply_filter(FILTER, result="details", steps=1)
    assert len(lonely) > 100
    assert not mesh.vertex_scalar_array()[lonely].any()
    mesh_set.apply_filter(FILTER, result="details", steps=1, crease_angle=1e-9)
    details = mesh.vertex_custom_point_attribute_matrix("spectral_details")
    assert np.abs(details).max() < 1e-2 * diagonal(mesh.vertex_matrix())
