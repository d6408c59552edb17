"""The command `meshlab-spectral filter`: its results and its report."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh
from commands import arrays_of, assert_fails, command, messages_in, succeeded, write_ply
from helpers import FILTER, loaded, lower_part, mesh_set_of, percent
from meshlab_spectral import FilterOptions, OptionError, filter_mesh
from meshlab_spectral.files.region import Region
from meshlab_spectral.files.region_vertices import chosen_parts
from meshlab_spectral.formats.document import Part
from shapes import sphere
from shared_types import Decimated


def test_output_is_what_the_filter_computes(cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "cow.ply"
    done = succeeded("filter", cow, target, "--feature-size", "4%", "--steps", 3)
    assert messages_in(done.stderr) == "Warning: cow.ply loses comments.\n"
    mesh_set = loaded(cow)
    mesh_set.apply_filter(FILTER, feature_size=percent(4), steps=3)
    V, F = arrays_of(target)
    np.testing.assert_array_equal(V, mesh_set.current_mesh().vertex_matrix())
    np.testing.assert_array_equal(F, mesh_set.current_mesh().face_matrix())
    assert list(tmp_path.iterdir()) == [target]


def test_json_is_one_object_with_report_options_and_versions(cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "cow.ply"
    done = succeeded("filter", cow, target, "--json", "--feature-size", 0.15, "--steps", 2)
    assert done.stdout.count("\n") == 1
    record = json.loads(done.stdout)
    assert record["input"] == str(cow)
    assert record["output"] == str(target)
    expected = {**FilterOptions().as_dict(), "feature_size": "0.15", "steps": 2}
    assert record["options"] == expected
    assert record["report"]["feature_size"] == pytest.approx(0.15, rel=1e-6)
    assert record["report"]["step_sizes"] == [0.5, 0.5]
    assert record["report"]["max_displacement"] > 0
    assert record["versions"]["pymeshlab"] == "2025.7.post1"
    assert {"meshlab_spectral", "python"} <= record["versions"].keys()


@pytest.mark.parametrize(("feature_size", "warned"), [("5%", True), ("60%", False)])
def test_harmonics_that_end_above_the_feature_size_are_a_warning(
    cow: Path, tmp_path: Path, feature_size: str, warned: bool
) -> None:
    arguments = ["--spectrum", "truncated", "--basis-size", 30, "--steps", 1]
    done = succeeded(
        "filter", cow, tmp_path / "cow.ply", *arguments, "--feature-size", feature_size
    )
    assert ("harmonics end at features of" in done.stderr) == warned


def test_json_holds_the_eigenvalues_of_a_truncated_spectrum(cow: Path, tmp_path: Path) -> None:
    arguments = ["--spectrum", "truncated", "--basis-size", 50, "--steps", 1, "--json"]
    done = command("filter", cow, tmp_path / "cow.ply", *arguments, "--no-reinject-residual")
    record = json.loads(done.stdout)
    assert len(record["report"]["eigenvalues"]) >= 50
    assert record["options"]["reinject_residual"] is False


def test_report_is_a_table_with_the_input_and_the_output_as_they_were_named(
    cow: Path, tmp_path: Path
) -> None:
    source = tmp_path / "[red] kühe.obj"
    shutil.copy(cow, source)
    done = succeeded("filter", source, tmp_path / "[bold]öut.ply", "--steps", 1)
    assert "[red] kühe.obj -> [bold]öut.ply" in done.stdout
    for row in ("Feature size", "Largest displacement", "Area", "Volume", "Work"):
        assert row in done.stdout
    assert len(arrays_of(tmp_path / "[bold]öut.ply")[0]) == len(arrays_of(cow)[0])


def test_the_table_tells_where_a_bound_was_reached(cow: Path, tmp_path: Path) -> None:
    bounded = ("--feature-size", "20%", "--max-displacement", "0.1%")
    done = command("filter", cow, tmp_path / "out.ply", *bounded)
    _, report = filter_mesh(*arrays_of(cow), feature_size="20%", max_displacement="0.1%")
    share = f"{100 * report['limited_share']:.2g}"
    assert re.search(rf"Bound reached at\W+{re.escape(share)} % of the surface", done.stdout)


def test_an_open_surface_has_no_volume_in_the_table(decimated: Decimated, tmp_path: Path) -> None:
    mesh_set_of(*lower_part(*decimated("cow.obj"))).save_current_mesh(str(tmp_path / "half.ply"))
    done = command("filter", tmp_path / "half.ply", tmp_path / "smooth.ply", "--steps", 1)
    assert "Area" in done.stdout
    assert "Volume" not in done.stdout


def test_volumes_that_cancel_are_zero_not_shares_of_round_off(tmp_path: Path) -> None:
    V, F = sphere(2)
    V = np.add(V, (4, 0, 0)).astype(np.float32).astype(float)
    mirrored = V * (-1, 1, 1)  # inside out
    both = mesh_set_of(np.vstack([V, mirrored]), np.vstack([F, F + len(V)]))
    both.save_current_mesh(str(tmp_path / "mirrored.ply"))
    done = succeeded("filter", tmp_path / "mirrored.ply", tmp_path / "out.ply", "--steps", 1)
    assert re.search(r"Volume\W+0 -> 0 +│", done.stdout)


def test_a_vertex_that_is_not_a_number_is_named(existing: Path, tmp_path: Path) -> None:
    """MeshLab would drop it and its faces, and so leave an unexpected hole."""
    vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\nnan 0 0"
    faces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n3 0 1 4"
    source = write_ply(tmp_path / "nan.ply", vertices, faces)
    assert_fails(
        command("filter", source, existing, "--overwrite"), 1, str(source), "vertex 4 is at nan 0 0"
    )


@pytest.mark.parametrize("element", ["vertex", "face"])
def test_only_the_selection_stored_in_a_ply_file_is_filtered(
    element: str, samples: Path, tmp_path: Path
) -> None:
    mesh_set = loaded(samples / "bunny.obj")
    if element == "vertex":
        mesh_set.compute_selection_by_condition_per_vertex(condselect="x > 0.2")
    else:
        mesh_set.compute_selection_by_condition_per_face(condselect="x0 > 0.2")
    flags = {"save_vertex_flag": element == "vertex", "save_face_flag": element == "face"}
    source, target = tmp_path / "selected.ply", tmp_path / "out.ply"
    mesh_set.save_current_mesh(str(source), **flags)
    succeeded("filter", source, target, "--selected", "--feature-size", "5%", "--quiet")
    before, after = arrays_of(source)[0], arrays_of(target)[0]
    moved = (before != after).any(axis=1)
    assert 100 < moved.sum() < 0.8 * len(before)
    assert before[moved, 0].min() > 0.1
    assert target.read_bytes()[:200] == source.read_bytes()[:200]  # the flags stay


@pytest.mark.parametrize("verb", ["filter", "denoise"])
@pytest.mark.parametrize("ending", ["ply", "obj", "glb"])
def test_a_selection_that_the_file_does_not_have_is_refused(
    verb: str, ending: str, tmp_path: Path
) -> None:
    source, target = tmp_path / f"in.{ending}", tmp_path / f"out.{ending}"
    trimesh.creation.icosphere(2).export(source)
    for more in ([], ["--dry-run"]):
        assert_fails(command(verb, source, target, "--selected", *more), 2, "nothing is selected")
        assert not target.exists()


def test_of_several_meshes_those_with_a_selection_are_filtered() -> None:
    V, F = np.eye(3), np.array([[0, 1, 2]])
    bare, part = Part("", V, F), Part("", V, F, selected=np.array([True, False, False]))
    options = FilterOptions(selected=True)
    assert chosen_parts([bare, part], options, Region()) == [None, part]
    assert chosen_parts([bare, part], FilterOptions(), Region()) == [bare, part]
    with pytest.raises(OptionError, match="nothing is selected"):
        chosen_parts([bare, bare], options, Region())
