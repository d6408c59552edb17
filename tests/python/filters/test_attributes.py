"""The filter moves vertices and leaves everything else of a mesh unchanged."""

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
    filter_arrays,
    loaded,
    mesh_set_of,
    percent,
    snapshot,
)
from shared_types import Decimated

MOVED = {"vertex_matrix", "vertex_normal_matrix", "face_normal_matrix"}
# What each filter changes.
TARGETS: dict[str, tuple[dict[str, Any], set[str]]] = {
    FILTER: ({"steps": 2}, MOVED),
    "apply_coord_spectral_denoise": ({"noise_height": percent(0.5)}, MOVED),
    "apply_scalar_spectral_filter_per_vertex": ({}, {"vertex_scalar_array"}),
    "apply_color_spectral_filter_per_vertex": ({}, {"vertex_color_matrix"}),
}


@pytest.mark.parametrize("name", TARGETS)
def test_every_other_attribute_is_kept(name: str, decimated: Decimated) -> None:
    mesh_set = decorated(*decimated("cow.obj"))
    mesh = mesh_set.current_mesh()
    before, custom_before, box = snapshot(mesh), custom_attributes(mesh), mesh.bounding_box()
    assert 0 < mesh.selected_vertex_number() < mesh.vertex_number()
    assert 0 < mesh.selected_face_number() < mesh.face_number()
    parameters, targets = TARGETS[name]
    assert targets < before.keys()
    assert len(before) == 12
    mesh_set.apply_filter(name, **parameters)
    after = snapshot(mesh)
    for target in targets:
        assert not np.array_equal(before.pop(target), after.pop(target)), target
    assert_same(before, after)
    assert_same(custom_before, custom_attributes(mesh))
    if targets != MOVED:
        np.testing.assert_array_equal(mesh.bounding_box().max(), box.max())


def test_textures_are_kept(samples: Path) -> None:
    mesh_set = loaded(samples / "bunny10k_textured.obj")
    mesh = mesh_set.current_mesh()
    textures, coordinates = list(mesh.textures()), mesh.wedge_tex_coord_matrix()
    assert textures == ["TextureDouble_A.png"]
    mesh_set.apply_filter(FILTER, steps=1)
    assert list(mesh.textures()) == textures
    np.testing.assert_array_equal(mesh.wedge_tex_coord_matrix(), coordinates)


def test_normals_and_bounding_box_are_those_of_the_new_shape(decimated: Decimated) -> None:
    mesh_set = mesh_set_of(*decimated("bunny.obj"))
    mesh_set.apply_filter(FILTER, feature_size=percent(20), steps=2, basis_update="conformal")
    mesh = mesh_set.current_mesh()
    V, F = mesh.vertex_matrix(), mesh.face_matrix()
    np.testing.assert_allclose(mesh.bounding_box().min(), V.min(axis=0), rtol=0, atol=1e-15)
    np.testing.assert_allclose(mesh.bounding_box().max(), V.max(axis=0), rtol=0, atol=1e-15)
    N = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    N /= np.linalg.norm(N, axis=1, keepdims=True)
    found = mesh.face_normal_matrix()
    found = found / np.linalg.norm(found, axis=1, keepdims=True)
    np.testing.assert_allclose(found, N, rtol=0, atol=1e-9)
    at_corners = np.einsum("fj,fcj->fc", N, mesh.vertex_normal_matrix()[F])
    assert np.median(at_corners) > 0.9


def test_normals_are_meshlabs_to_the_last_bit(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj")
    V = np.vstack([V, [[1.0, 2.0, 3.0]]])  # of no face
    F = np.vstack([F, F[:1], F[-1:, [0, 0, 1]]])  # a face twice, and one without area
    mesh_set = mesh_set_of(V, F)
    mesh_set.apply_filter(FILTER)
    mesh = mesh_set.current_mesh()
    fresh = pymeshlab.Mesh(mesh.vertex_matrix(), mesh.face_matrix())
    for normals in ("vertex_normal_matrix", "face_normal_matrix"):
        np.testing.assert_array_equal(getattr(mesh, normals)(), getattr(fresh, normals)())


def test_other_meshes_of_the_set_are_unchanged(decimated: Decimated) -> None:
    mesh_set = mesh_set_of(*decimated("bone.ply"))
    mesh_set.add_mesh(pymeshlab.Mesh(*decimated("cow.obj")))
    before = snapshot(mesh_set.mesh(0))
    mesh_set.apply_filter(FILTER, steps=1)
    assert_same(before, snapshot(mesh_set.mesh(0)))


@pytest.mark.parametrize("what", ["vertices", "faces"])
def test_after_a_deletion_only_remaining_elements_count(
    what: str, decimated: Decimated, tmp_path: Path
) -> None:
    """Deletion and filter run as one script, so that pymeshlab touches nothing in between."""
    V, F = decimated("cow.obj")
    script = mesh_set_of(V, F)
    script.compute_selection_by_condition_per_vertex(condselect="(z > 0.4)")
    if what == "vertices":
        script.meshing_remove_selected_vertices()
    else:
        script.compute_selection_transfer_vertex_to_face()
        script.meshing_remove_selected_faces()
    clean = script.current_mesh()
    assert 0 < clean.face_number() < len(F)
    expected, _ = filter_arrays(
        clean.vertex_matrix(), clean.face_matrix(), feature_size=pymeshlab.PureValue(0.25), steps=2
    )
    script.apply_filter(FILTER, feature_size=pymeshlab.PureValue(0.25), steps=2)
    script.save_filter_script(str(tmp_path / "script.mlx"))

    replay = mesh_set_of(V, F)
    replay.load_filter_script(str(tmp_path / "script.mlx"))
    replay.apply_filter_script()

    for mesh_set in (script, replay):
        np.testing.assert_allclose(
            mesh_set.current_mesh().vertex_matrix(), expected, rtol=0, atol=1e-14
        )
