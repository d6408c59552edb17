"""The report is true, and what must not move does not move."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
import spectral_reference as reference
from helpers import (
    FILTER,
    diagonal,
    filter_arrays,
    largest_distance,
    length,
    lower_part,
    mesh_set_of,
    percent,
)
from meshlab_spectral import filter_mesh
from shared_types import Decimated


@pytest.mark.parametrize(
    "parameters",
    [
        {"feature_size": percent(15), "steps": 4, "basis_update": "conformal"},
        {"filter_type": "band-pass", "stop_gain": 1.0, "pass_gain": 2.0, "steps": 2},
    ],
    ids=["low-pass", "enhancement"],
)
def test_measures_agree_with_those_of_numpy(
    sample_name: str, parameters: dict[str, Any], decimated: Decimated
) -> None:
    V, F = decimated(sample_name)
    Y, report = filter_arrays(V, F, **parameters)
    moved = np.linalg.norm(Y - V, axis=1)
    d = reference.lumped_areas(V, F)
    centre = (V.min(axis=0) + V.max(axis=0)) / 2
    expected = {
        "max_displacement": moved.max(),
        "rms_displacement": np.sqrt(np.sum(d * moved**2) / np.sum(d)),
        "area_before": reference.triangle_areas(V, F).sum(),
        "area_after": reference.triangle_areas(Y, F).sum(),
        "volume_before": reference.signed_volume(V, F, centre),
        "volume_after": reference.signed_volume(Y, F, centre),
        "cutoff_frequency": 2 * np.pi / report["feature_size"],
    }
    for name, value in expected.items():
        assert report[name] == pytest.approx(value, rel=1e-9), name


def test_only_a_closed_surface_has_a_volume(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    assert filter_arrays(V, F, steps=1)[1]["has_volume"]
    assert not filter_arrays(*lower_part(V, F), steps=1)[1]["has_volume"]


def test_feature_size_is_a_percentage_of_the_diagonal_or_a_length(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    _, of_diagonal = filter_arrays(V, F, feature_size=percent(8), steps=1)
    assert of_diagonal["feature_size"] == pytest.approx(0.08 * diagonal(V), rel=1e-6)
    _, absolute = filter_arrays(V, F, feature_size=length(0.3), steps=1)
    assert absolute["feature_size"] == pytest.approx(0.3, rel=1e-6)


def test_a_filter_script_saved_and_loaded_gives_the_same_result(
    decimated: Decimated, tmp_path: Path
) -> None:
    V, F = decimated("cow.obj")
    original = mesh_set_of(V, F)
    original.apply_filter(
        FILTER,
        filter_type="band-pass",
        response="butterworth",
        order=3,
        band_width=1.5,
        feature_size=percent(12),
        stop_gain=1.0,
        pass_gain=2.0,
        steps=3,
        basis_update="conformal",
    )
    script = tmp_path / "script.mlx"
    original.save_filter_script(str(script))
    assert "Spectral Filter (Fractional)" in script.read_text()

    replay = mesh_set_of(V, F)
    replay.load_filter_script(str(script))
    replay.apply_filter_script()
    # A script holds numbers of six digits or so.
    assert largest_distance(
        replay.current_mesh().vertex_matrix(), original.current_mesh().vertex_matrix()
    ) < 1e-6 * diagonal(V)
    assert not np.allclose(replay.current_mesh().vertex_matrix(), V)


def test_where_every_vertex_is_fixed_nothing_moves() -> None:
    V, F = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    Y, report = filter_arrays(V, F, boundary="fixed")
    np.testing.assert_array_equal(Y, V)
    assert report["max_displacement"] == 0
    assert report["fixed_vertices"] == 3


def test_reports_how_far_creases_are_rounded() -> None:
    def rounded(mesh_set: pymeshlab.MeshSet, **options: Any) -> tuple[float, float]:
        mesh = mesh_set.current_mesh()
        V = mesh.vertex_matrix()
        X, report = filter_mesh(V, mesh.face_matrix(), **options)
        on = ((V.min(axis=0) == V) | (V.max(axis=0) == V)).sum(axis=1) == 2  # no corners
        return report["rounded_creases"], np.linalg.norm(X - V, axis=1)[on].max(initial=0.0)

    block, ball = pymeshlab.MeshSet(), pymeshlab.MeshSet()
    block.create_cube()
    block.meshing_surface_subdivision_midpoint(iterations=5, threshold=pymeshlab.PercentageValue(0))
    ball.create_sphere(subdiv=5)
    reported, moved = rounded(block)
    assert reported == pytest.approx(moved, rel=1e-12)
    assert moved > 0
    assert rounded(block, crease_angle=50)[0] == 0
    assert rounded(ball)[0] == 0
