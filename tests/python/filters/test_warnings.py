"""Warnings reach Python in the plugin's words, and only those of the run that caused them."""

from __future__ import annotations

import json
import re
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from batches import REPORT, make_meshes, records
from commands import command, messages_in, python, write_ply
from helpers import FILTER, mesh_set_of, percent, refusal
from meshlab_spectral import filter_files, filter_mesh, filter_scalars
from meshlab_spectral.files.script import apply_script
from meshlab_spectral.filters.options import TransferKeywords
from meshlab_spectral.filters.running import SHELL
from meshlab_spectral.plugin.library import last_warnings
from meshlab_spectral.plugin.mesh_sets import call_filter
from shapes import grid, quads
from shared_types import Decimated

TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
# Each falls short in a different way.
INACCURATE = {"filter_type": "custom", "transfer_function": "abs(w - 1)", "steps": 20}
FEW_HARMONICS = {"spectrum": "truncated", "basis_size": 30, "steps": 1}
EVERYTHING_FIXED = {"boundary": "fixed", "steps": 1}


PROGRAM = """
import json, sys
import meshlab_spectral, pymeshlab
from meshlab_spectral.plugin.mesh_sets import call_filter
meshlab_spectral.load()
mesh_set = pymeshlab.MeshSet(verbose=True)
mesh_set.load_new_mesh(sys.argv[1])
report = call_filter(mesh_set, sys.argv[2], json.loads(sys.argv[3]))
print("WARNINGS", json.dumps(report["warnings"]))
"""


def log_of(source: Path, name: str, options: dict[str, Any]) -> str:
    """What pymeshlab prints during a call, and a line with its warnings."""
    done = python("-c", PROGRAM, source, name, json.dumps(options), check=True)
    return done.stdout + done.stderr


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("cow.obj", FEW_HARMONICS, "harmonics end at features of"),
        ("triangle.ply", EVERYTHING_FIXED, "nothing can move"),
        ("cow.obj", {"steps": 1}, None),
    ],
)
def test_the_report_has_the_warnings_of_meshlabs_log(
    name: str, options: dict[str, Any], words: str | None, samples: Path, tmp_path: Path
) -> None:
    triangle = write_ply(tmp_path / "triangle.ply", "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    source = triangle if name == triangle.name else samples / name
    log = log_of(source, FILTER, options)
    (line,) = (line for line in log.splitlines() if line.startswith("WARNINGS "))
    warnings = json.loads(line.removeprefix("WARNINGS "))
    in_log = re.findall(r"WARNING: (.*)", log)
    assert [warning.strip() for warning in in_log] == warnings
    assert len(warnings) == (words is not None)
    assert (words or "") in "".join(warnings)


@pytest.mark.parametrize("name", [FILTER, "apply_coord_spectral_denoise"])
def test_the_log_has_volumes_of_closed_surfaces_only(
    name: str, samples: Path, tmp_path: Path
) -> None:
    open_one = write_ply(tmp_path / "open.ply", "0 0 0\n1 0 0\n0 1 0\n1 1 1", "3 0 1 2\n3 2 1 3")
    assert "volume: none, as the surface is open" in log_of(open_one, name, {})
    assert re.search(r"volume: \S+ -> \S+", log_of(samples / "cow.obj", name, {}))


def test_the_log_of_a_geometry_spectrum_is_a_chart(samples: Path) -> None:
    log = log_of(samples / "cow.obj", "get_geometry_spectrum", {})
    rows = re.findall(r"  (\u2588+) (\S+) at \S+ \(", log)
    assert len(rows) > 4
    amplitudes = np.array([float(number) for _, number in rows])
    cells = 12 + 3 * np.log10(amplitudes / amplitudes.max())
    assert np.abs(np.maximum(1, cells) - [len(bar) for bar, _ in rows]).max() < 0.51


@pytest.mark.slow
def test_every_flag_of_a_shortfall_comes_with_a_warning(decimated: Decimated) -> None:
    """Flags and warnings come by two separate ways, which must agree."""
    V, F = decimated("cow.obj")
    _, whole = filter_mesh(V, F)
    assert whole["accuracy_reached"]
    assert whole["tolerance_reached"]
    assert whole["warnings"] == []
    _, inaccurate = filter_mesh(V, F, **INACCURATE)
    assert not inaccurate["accuracy_reached"]
    assert "Choose gains closer to 1" in inaccurate["warnings"][0]
    _, few = filter_mesh(V, F, **FEW_HARMONICS)
    assert not few["cutoff_reached"]
    assert "basis_size" in few["warnings"][0]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"filter_type": "high-pass"}, "stop_gain = 1"),
        ({"feature_size": "20%", "basis_update": "full"}, "basis_update = conformal"),
        ({"filter_type": "band-pass", "stop_gain": 1.0, "pass_gain": 1e10}, "smaller gains"),
    ],
)
def test_steps_that_do_not_converge_recommend_an_option_not_yet_chosen(
    options: dict[str, Any], words: str, decimated: Decimated
) -> None:
    _, report = filter_mesh(*decimated("cow.obj"), **options)
    assert not report["tolerance_reached"]
    (warning,) = (text for text in report["warnings"] if "tolerance" in text)
    assert words in warning
    assert warning.endswith("or a larger tolerance")
    assert ("conformal" in warning) == ("basis_update" in options)
    assert not re.search(r"e\+\d+ %", warning)


def test_faces_that_fold_over_are_counted_and_come_with_the_remedy(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    paper: dict[str, Any] = {"feature_size": "10%", "steps": 10, "basis_update": "full"}
    X, report = filter_mesh(V, F, **paper)
    before, after = (np.cross(P[F[:, 1]] - P[F[:, 0]], P[F[:, 2]] - P[F[:, 0]]) for P in (V, X))
    around = np.zeros_like(V)
    for corner in F.T:
        np.add.at(around, corner, after)
    turned = np.einsum("ij,ij->i", before, after) < 0
    opposed = np.einsum("ij,ij->i", around[F].sum(axis=1) - 3 * after, after) < 0
    area = np.linalg.norm(after, axis=1)
    assert report["folded_faces"] == np.sum(turned & opposed & (area > 0.01 * area.mean())) > 0
    (warning,) = (text for text in report["warnings"] if "folded over" in text)
    assert "basis_update = conformal" in warning
    _, conformal = filter_mesh(V, F, **(paper | {"basis_update": "conformal"}))
    assert conformal["folded_faces"] < report["folded_faces"] / 4


def test_a_gain_of_what_is_largest_is_said_to_scale_the_object(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    for options in ({"pass_gain": 1.5}, {"filter_type": "high-pass", "stop_gain": 1.5}):
        warnings = filter_mesh(V, F, feature_size="5%", **options)[1]["warnings"]
        assert any(
            "largest details is 1.5, which scales the whole object" in text for text in warnings
        )
    details = {"filter_type": "high-pass", "stop_gain": 1.0, "pass_gain": 1.5}
    warnings = filter_mesh(V, F, feature_size="5%", **details)[1]["warnings"]
    assert not any("scales" in text for text in warnings)


def warnings_in_mesh_set(V: Any, F: Any, name: str = FILTER, **options: Any) -> list[str]:
    """The warnings of a run of the plugin in this thread."""
    found: list[str] = call_filter(mesh_set_of(V, F), name, options)["warnings"]
    assert found == last_warnings()
    return found


def test_an_earlier_runs_warnings_are_not_those_of_a_later_one(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    assert warnings_in_mesh_set(*TRIANGLE, **EVERYTHING_FIXED)
    assert warnings_in_mesh_set(V, F, steps=1) == []
    assert warnings_in_mesh_set(*TRIANGLE, **EVERYTHING_FIXED)
    assert warnings_in_mesh_set(V, F, "get_geometry_spectrum", basis_size=10) == []


def test_a_run_that_fails_has_no_warnings() -> None:
    assert warnings_in_mesh_set(*TRIANGLE, **EVERYTHING_FIXED)
    refusal(mesh_set_of(*TRIANGLE), order=0, response="butterworth")
    assert last_warnings() == []


def test_another_threads_run_leaves_a_threads_warnings_alone(decimated: Decimated) -> None:
    own = warnings_in_mesh_set(*TRIANGLE, **EVERYTHING_FIXED)
    assert own
    found: list[list[str]] = []

    def run() -> None:
        found.append(last_warnings())
        found.append(warnings_in_mesh_set(*decimated("cow.obj"), steps=1))

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert found == [[], []]
    assert last_warnings() == own


def script_of(folder: Path, name: str, **parameters: Any) -> Path:
    mesh_set = mesh_set_of(*TRIANGLE)
    mesh_set.apply_filter(FILTER, **parameters)
    script = folder / name
    mesh_set.save_filter_script(str(script))
    return script


def test_every_filter_of_a_script_has_its_own_warnings(tmp_path: Path) -> None:
    fixed = script_of(tmp_path, "fixed.mlx", **EVERYTHING_FIXED).read_text()
    free = script_of(tmp_path, "free.mlx", steps=1, feature_size=percent(100)).read_text()
    part = free[free.index("<filter ") : free.index("</FilterScript>")]
    report = apply_script(
        mesh_set_of(*TRIANGLE), fixed.replace("</FilterScript>", part + "</FilterScript>")
    )
    first, second = (one["report"]["warnings"] for one in report["filters"])
    assert "nothing can move" in first[0]
    assert second == []


def test_a_batch_of_a_script_keeps_the_warnings_of_its_filters(tmp_path: Path) -> None:
    script = script_of(tmp_path, "fixed.mlx", **EVERYTHING_FIXED)
    flat = write_ply(tmp_path / "flat.ply", "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    (closed,) = make_meshes(tmp_path / "in", 1)
    out = tmp_path / "out"
    for resume in (False, True):
        results = filter_files([flat, closed], out, script=script, workers=1, resume=resume)
        warnings = {result.name: result.warnings for result in results}
        assert "nothing can move" not in "".join(warnings[closed.name])
        assert "nothing can move" in warnings["flat.ply"][0]
    kept = {record["name"]: record["warnings"] for record in records(out / REPORT)}
    assert kept == warnings


def test_json_has_the_warning_that_standard_error_shows(tmp_path: Path) -> None:
    source = write_ply(tmp_path / "flat.ply", "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    done = command("filter", source, tmp_path / "out.ply", "--boundary", "fixed", "--json")
    (warning,) = json.loads(done.stdout)["report"]["warnings"]
    assert "Choose --boundary free; if the triangles are not connected, merge close" in warning
    assert messages_in(done.stderr) == f"Warning: {warning}.\n"


@pytest.mark.parametrize(
    ("options", "warning"),
    [
        ({"transfer_function": "1"}, "transfer_function has no effect without filter_type = cus"),
        ({"order": 4}, "order has no effect without response = butterworth"),
        ({"band_width": 2.0}, "band_width has no effect without filter_type = band-pass"),
        ({"filter_type": "custom", "pass_gain": 2.0}, "pass_gain has no effect with filter_type"),
        ({"filter_type": "custom", "order": 4}, "order has no effect without response"),
        ({"conformal_share": 0.5}, "conformal_share has no effect without basis_update = full"),
        ({"basis_size": 50}, "basis_size has no effect without spectrum = truncated"),
        ({"reinject_residual": False}, "reinject_residual has no effect without spectrum"),
    ],
)
def test_an_option_without_effect_is_reported(
    options: dict[str, Any], warning: str, decimated: Decimated
) -> None:
    V, F = decimated("bunny.obj", 500)
    (found,) = filter_mesh(V, F, feature_size="2e", **options)[1]["warnings"]
    assert warning in found
    if set(options) <= TransferKeywords.__annotations__.keys():
        (found,) = filter_scalars(V, F, V[:, 0], **options)[1]["warnings"]
        assert warning in found


def test_an_option_with_an_effect_is_not_reported(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj", 500)
    for options in (
        {"filter_type": "custom", "transfer_function": "1/(1 + w^2)"},
        {"response": "butterworth", "order": 4},
        {"filter_type": "band-stop", "band_width": 0.5, "stop_gain": 0.05},
        {"basis_update": "full", "conformal_share": 0.5, "steps": 2},
    ):
        assert filter_mesh(V, F, feature_size="2e", **options)[1]["warnings"] == [], options


def test_a_size_below_the_edges_is_a_warning(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj", 500)
    report = filter_mesh(V, F, feature_size="0.5e")[1]
    (warning,) = report["warnings"]
    assert "the mesh has no details of the feature size" in warning
    assert f"Choose at least two edges, {2 * report['mean_edge']:.3g}; " in warning
    assert filter_mesh(V, F, feature_size="1.1e")[1]["warnings"] == []


def test_a_part_that_shrinks_to_a_line_is_reported_with_a_size_that_keeps_it() -> None:
    # A ball with a long thin handle, of a fifth of the area.
    ball = pyvista.Icosphere(radius=1.0, nsub=4)
    rod = pyvista.Cylinder(center=(0, 0, 3), direction=(0, 0, 1), radius=0.15, height=4.2)
    rod = rod.triangulate().subdivide(4)
    mesh = ball.merge(rod).extract_surface(algorithm=None).triangulate()
    _, report = filter_mesh(mesh, feature_size=1.6)
    (warning,) = report["warnings"]
    assert "of the surface shrinks to lines or points" in warning
    assert "Try feature_size = 0.8 (" in warning
    assert 0.1 < report["shrunken_part"] < 0.3
    assert filter_mesh(mesh, feature_size=0.4)[1]["warnings"] == []


def cells(side: int, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A height field of cells of 30."""
    x, y = (30.0 * one.ravel() for one in np.meshgrid(np.arange(side), np.arange(side)))
    k = np.arange(side * side).reshape(side, side)
    a, b, c, d = (one.ravel() for one in (k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]))
    return np.column_stack([x, y, height]), np.vstack(
        [np.stack(t, 1) for t in ((a, b, c), (a, c, d))]
    )


@pytest.mark.parametrize("filler", [-9999.0, -32768.0])
def test_missing_data_in_a_terrain_are_named_with_the_option_that_leaves_them_out(
    filler: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(3)
    height = 50 * np.sin(np.arange(900) / 40) + rng.normal(size=900)
    lake = [100, 101, 130, 131, 500]
    V, F = cells(30, height)
    expected, plain = filter_mesh(V, F)
    V[lake, 2] = filler
    _, report = filter_mesh(V, F)
    (warning,) = (text for text in report["warnings"] if "missing data" in text)
    assert warning.startswith(f"5 vertices have z = {filler:g}, far from all others")
    assert f"(where = z > {filler:g})" in warning
    with monkeypatch.context() as in_shell:
        in_shell.setenv(SHELL, "1")
        assert any(f"--where 'z > {filler:g}'" in w for w in filter_mesh(V, F)[1]["warnings"])
    assert report["feature_size"] == pytest.approx(plain["feature_size"], rel=0.02)
    kept = V[:, 2] != filler
    selected, report = filter_mesh(V, F, selection=kept)
    far = kept & (np.abs(V[:, 0] - 300) + np.abs(V[:, 1] - 100) > 500) & (V[:, 1] < 400)
    assert far.sum() > 20
    np.testing.assert_allclose(selected[far], expected[far], atol=0.05)
    np.testing.assert_array_equal(selected[lake], V[lake])


def test_a_periodic_cell_that_loses_its_match_is_told() -> None:
    wave = np.linspace(0, 2 * np.pi, 31)
    height = np.random.default_rng(5).normal(size=(31, 31)) + 20 * np.sin(wave)[:, None]
    height[:, -1], height[-1] = height[:, 0], height[0]
    height[-1, -1] = height[0, 0]
    V, F = cells(31, height.ravel())
    _, report = filter_mesh(V, F)
    (warning,) = (text for text in report["warnings"] if "periodic" in text)
    assert warning.startswith("62 pairs of vertices on opposite sides matched by a translation")
    assert "boundary = fixed" in warning
    _, report = filter_mesh(V, F, boundary="fixed")
    assert not any("periodic" in text for text in report["warnings"])
    V[5, 2] += 1  # a cell along the other axis only
    (warning,) = (text for text in filter_mesh(V, F)[1]["warnings"] if "periodic" in text)
    assert warning.startswith("31 pairs")
    V[31 * 5, 2] += 1
    assert not any("periodic" in text for text in filter_mesh(V, F)[1]["warnings"])


def test_a_periodic_cell_whose_sides_are_not_flat_is_told() -> None:
    """Nodes were moved along the normals, opposite ones alike: the box is larger than the cell."""
    V, F = cells(31, np.random.default_rng(5).normal(size=31 * 31))
    sides = np.random.default_rng(6).normal(scale=0.1, size=(2, 30, 3))
    grid = V.reshape(31, 31, 3)
    for line in (grid[:, 0], grid[:, 30]):
        line[:30] = line[:30] * [1, 1, 0] + sides[0]
    for line in (grid[0], grid[30]):
        line[:30] = line[:30] * [1, 1, 0] + sides[1]
    step = grid[30, 1] - grid[0, 1]
    other = grid[1, 30] - grid[1, 0]
    corner = grid[0, 0].copy()
    for i, j in ((30, 0), (0, 30), (30, 30)):
        grid[i, j] = corner + (i > 0) * step + (j > 0) * other
    _, report = filter_mesh(V, F)
    (warning,) = (text for text in report["warnings"] if "periodic" in text)
    assert warning.startswith("62 pairs of vertices on opposite sides matched by a translation")


def test_neither_a_tube_nor_a_duct_nor_a_box_of_six_faces_is_a_periodic_cell() -> None:
    cube = pyvista.Cube(clean=False).triangulate()
    assert cube.n_points == 24
    _, report = filter_mesh(np.array(cube.points, float), cube.regular_faces)
    assert not any("periodic" in text for text in report["warnings"])
    around, along = np.meshgrid(np.arange(32), np.arange(20), indexing="ij")
    F = quads(grid(32, 20, 0))
    angle = 2 * np.pi * around / 32
    x, y = np.cos(angle), np.sin(angle)
    for side in (1, np.maximum(abs(x), abs(y))):
        V = np.stack([x / side, y / side, along / 5], axis=-1).reshape(-1, 3)
        _, report = filter_mesh(V, F)
        assert report["max_displacement"] > 0
        assert not any("periodic" in text for text in report["warnings"])


def test_a_triangle_of_equal_points_is_ignored_and_counted() -> None:
    V, F = cells(20, np.random.default_rng(5).normal(size=400))
    expected, _ = filter_mesh(V, F)
    with_debris = np.vstack([V, np.full((3, 3), 0.5)])
    moved, report = filter_mesh(with_debris, np.vstack([F, [[400, 401, 402]]]))
    np.testing.assert_allclose(moved[:400], expected, atol=1e-6)
    np.testing.assert_array_equal(moved[400:], with_debris[400:])
    (warning,) = (text for text in report["warnings"] if "without area" in text)
    assert warning.startswith("1 component without area")
    assert report["unreferenced_vertices"] == 3
