"""The filter on the real meshes next to the project; skipped where they are absent."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
from commands import python
from helpers import loaded
from meshlab_spectral import measure_artefacts
from meshlab_spectral.plugin.loading import FILTERS
from shared_types import SharedMesh


def filtered(
    path: Path, percentage: float = 15, **options: Any
) -> tuple[pymeshlab.MeshSet, dict[str, Any]]:
    mesh_set = loaded(path)
    report = mesh_set.apply_coord_spectral_filter_fractional(
        feature_size=pymeshlab.PercentageValue(percentage), **options
    )
    return mesh_set, report


def test_with_the_defaults_no_vertex_moves_farther_than_the_feature_size(
    shared_mesh: SharedMesh,
) -> None:
    folder = shared_mesh("elephant.ply").parent
    files = [file for file in sorted(folder.iterdir()) if file.suffix in {".ply", ".obj", ".off"}]
    moved = {}
    for file in files:
        mesh_set = loaded(file)
        if mesh_set.current_mesh().face_number() == 0:
            continue
        report = mesh_set.apply_coord_spectral_filter_fractional()
        moved[file.name] = report["max_displacement"] / report["feature_size"]
    assert len(moved) > 20
    assert max(moved.values()) < 0.5, moved


@pytest.mark.parametrize("percentage", [15, 30])
@pytest.mark.parametrize(
    "name",
    [
        "T.ply",
        "rocker-arm.obj",
        "fandisk.off",
        "gears.stl",
        "thingi_1514499.stl",
        "angel_gatech_28k.ply",
        "dragon_40k.ply",
    ],
)
def test_a_strong_low_pass_of_a_closed_mesh_stays_finite(
    name: str, percentage: float, shared_mesh: SharedMesh
) -> None:
    mesh_set, report = filtered(shared_mesh(name), percentage, steps=10, basis_update="full")
    assert np.isfinite(mesh_set.current_mesh().vertex_matrix()).all()
    assert report["max_displacement"] > 0


def test_one_strong_low_pass_of_the_dragon_takes_few_solves(shared_mesh: SharedMesh) -> None:
    _, report = filtered(shared_mesh("dragon_40k.ply"), steps=1)
    assert report["accuracy_reached"]
    assert report["error_estimate"] <= 1e-6
    assert report["factorizations"] == 1
    assert report["solves"] / 3 <= 40


def test_conformal_steps_leave_the_dragon_smoother_than_one_shot(shared_mesh: SharedMesh) -> None:
    dragon = shared_mesh("dragon_40k.ply")
    one_shot, first = filtered(dragon, steps=1, basis_update="none")
    conformal, second = filtered(dragon, steps=10, basis_update="conformal")
    # The whiskers and horns that one shot leaves as spikes are drawn in.
    assert second["area_after"] < 0.97 * first["area_after"]
    meshes = [mesh_set.current_mesh() for mesh_set in (one_shot, conformal)]
    shapes = [(mesh.vertex_matrix(), mesh.face_matrix()) for mesh in meshes]
    assert (np.ptp(shapes[1][0], axis=0) < np.ptp(shapes[0][0], axis=0)).all()
    before, after = (measure_artefacts(V, F, first["feature_size"]) for V, F in shapes)
    assert after.rms < before.rms
    assert after.maximum < 0.75 * before.maximum


BENCHMARK = Path(__file__).resolve().parents[2] / "benchmarks" / "bench_contract.py"
ALL_NEAR_CREASES = "the whole surface is within this distance of its boundary or of creases"
# Mesh -> the calls that end with an error, and words of it. `make bench-contract` has all meshes.
ERRORS: dict[str, dict[str, str]] = {
    "T.ply": {
        **dict.fromkeys(("filter truncated", "harmonics large"), "choose at most 19"),
        **dict.fromkeys(("texture default", "texture cotangent"), ALL_NEAR_CREASES),
    },
    "bunny16k_points.ply": {"": "point cloud"},
    "office_chair.obj": dict.fromkeys(
        ("artefacts cotangent", "texture cotangent"), "24 triangles have no area"
    ),
    "non_manif_hole.ply": {},
    "many_small_holes.ply": dict.fromkeys(
        ("texture default", "texture all", "texture cotangent"), ALL_NEAR_CREASES
    ),
    "conrod.stl": dict.fromkeys(("texture default", "texture cotangent"), ALL_NEAR_CREASES),
    "greek_helmet.obj": {},
}


@pytest.mark.parametrize("name", ERRORS)
def test_every_filter_takes_a_real_mesh_at_three_settings_or_says_what_to_choose(
    name: str, shared_mesh: SharedMesh, tmp_path: Path
) -> None:
    table = tmp_path / "rows.json"
    done = python(BENCHMARK, shared_mesh(name), "--json", table)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = [json.loads(line) for line in table.read_text().splitlines()]
    assert len(rows) == 3 * len(FILTERS)
    expected = ERRORS[name]
    for row in rows:
        words = expected.get(f"{row['filter']} {row['setting']}", expected.get(""))
        assert (row["outcome"] == "error") == (words is not None), row
        assert words is None or words in row["texts"][0]
