"""The command `meshlab-spectral batch`: results, report, summary, exit codes."""

from __future__ import annotations

import json
import re
import shutil
import time
from pathlib import Path

import numpy as np
from batches import REPORT, contents, make_meshes, records
from broken_meshes import make_broken_meshes
from commands import (
    PRECIOUS,
    arrays_of,
    assert_fails,
    command,
    command_on_terminal,
    succeeded,
    write_ply,
)
from helpers import FILTER, diagonal, largest_distance, loaded, percent
from meshlab_spectral import FilterOptions
from meshlab_spectral.filters.option_types import Length


def test_good_meshes_are_filtered_and_bad_ones_reported(cow: Path, tmp_path: Path) -> None:
    source, out = tmp_path / "in", tmp_path / "out"
    good = make_meshes(source, 2)
    deep = source / "deep" / "cow.obj"
    deep.parent.mkdir()
    shutil.copy(cow, deep)
    reasons = make_broken_meshes(source, good[0])
    arguments = [
        "--output",
        out,
        "--recursive",
        "--steps",
        1,
        "--feature-size",
        "8%",
        "--workers",
        2,
    ]
    done = command("batch", source, source / "unknown.mesh3", *arguments)
    assert done.returncode == 1, done.stderr
    assert "Traceback" not in done.stderr
    assert "3 filtered, 10 failed" in done.stdout
    assert sorted(contents(out)) == ["deep/cow.obj", "torus_000.ply", "torus_001.ply"]
    by_name = {Path(record["input"]).name: record for record in records(out / REPORT)}
    assert by_name.keys() == {*reasons, "cow.obj", "torus_000.ply", "torus_001.ply"}
    for name, word in reasons.items():
        assert by_name[name]["outcome"] == "failed"
        assert word in by_name[name]["reason"]
        assert "please report it" not in by_name[name]["reason"]
        assert name in done.stderr
    options = FilterOptions(feature_size=Length(8, "%"), steps=1).as_dict()
    for record in by_name.values():
        assert record["options"] == options
    mesh_set = loaded(good[0])
    mesh_set.apply_filter(FILTER, feature_size=percent(8), steps=1)
    expected = mesh_set.current_mesh().vertex_matrix()
    np.testing.assert_array_equal(arrays_of(out / good[0].name)[0], expected)
    (summary,) = records(out / REPORT, "summary")
    assert (summary["filtered"], summary["failed"]) == (3, 10)


def test_resume_skips_what_is_proved_done_and_does_the_rest(tmp_path: Path) -> None:
    source, out = tmp_path / "in", tmp_path / "out"
    paths = make_meshes(source, 4)
    batch = ["batch", source, "--output", out, "--steps", 1, "--workers", 1, "--json"]
    succeeded(*batch)
    before = contents(out)
    make_meshes(source, 1, seed=9)  # new content for the first
    (out / paths[1].name).unlink()
    (out / paths[2].name).write_bytes(PRECIOUS)
    summary = json.loads(succeeded(*batch, "--resume").stdout)
    assert (summary["filtered"], summary["already_done"], summary["failed"]) == (3, 1, 0)
    after = contents(out)
    assert after.keys() == before.keys()
    assert [name for name in after if after[name] != before[name]] == [paths[0].name]
    again = json.loads(command(*batch, "--resume").stdout)
    assert (again["filtered"], again["already_done"]) == (0, 4)
    changed = command(*batch, "--resume", "--dry-run", "--feature-size", "3%")
    assert changed.stdout.count(" -> ") == 4
    assert "done already" not in changed.stdout


def test_resume_restores_materials_and_textures(samples: Path, tmp_path: Path) -> None:
    source, out = samples / "bunny10k_textured.obj", tmp_path / "out"
    batch = ["batch", source, "--output", out, "--steps", 1, "--workers", 1]
    succeeded(*batch)
    before = contents(out)
    material, texture = "bunny10k_textured.mtl", "TextureDouble_A.png"
    assert before.keys() == {source.name, material, texture}
    assert "1 already done" in command(*batch, "--resume").stdout
    (out / texture).unlink()
    (out / material).unlink()
    done = command(*batch, "--resume")
    assert "1 filtered, 0 failed in" in done.stdout
    assert contents(out) == before


def test_no_existing_file_is_replaced_unasked(tmp_path: Path) -> None:
    source, out = tmp_path / "in", tmp_path / "out"
    paths = make_meshes(source, 2)
    out.mkdir()
    (out / paths[1].name).write_bytes(PRECIOUS)
    batch = ["batch", source, "--output", out, "--steps", 1, "--workers", 1]
    assert_fails(command(*batch), 2, str(out / paths[1].name), "--overwrite")
    assert contents(out) == {paths[1].name: PRECIOUS}
    paths[1].rename(paths[1].with_suffix(".moved"))  # the input's fault is told first
    paths[1].mkdir()
    assert_fails(command(*batch), 1, f"{paths[1]} is a folder")
    paths[1].rmdir()
    paths[1].with_suffix(".moved").rename(paths[1])
    assert_fails(command(*batch, "--resume"), 2, "already exist", "report of the run", REPORT)
    succeeded(*batch, "--overwrite")
    assert len(arrays_of(out / paths[1].name)[0]) == 144
    # A file that is older than the first run of a report is not one of its outputs.
    now = time.time()
    first, last = (f'{{"kind": "run", "begun": {now + k}}}\n' for k in (-60, 60))
    (out / REPORT).write_text(last)
    assert_fails(command(*batch, "--resume"), 2, "already exist")
    (out / REPORT).write_text(first + last)
    succeeded(*batch, "--resume")


def test_a_dry_run_lists_the_outputs_and_does_nothing(tmp_path: Path) -> None:
    source = tmp_path / "in"
    make_meshes(source, 2)
    out = tmp_path / "out"
    done = succeeded(
        "batch", source, "--output", out, "--dry-run", "--name", "{stem}_x", "--format", "stl"
    )
    assert done.stdout.splitlines() == [
        f"{source}/torus_{k:03}.ply -> {out}/torus_{k:03}_x.stl" for k in range(2)
    ]
    assert not out.exists()


def test_results_that_fell_short_are_counted_and_their_warnings_kept(
    cow: Path, tmp_path: Path
) -> None:
    flat, out = tmp_path / "flat.ply", tmp_path / "out"
    write_ply(flat, "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    batch = ["batch", cow, flat, "--output", out, "--boundary", "fixed", "--workers", 1]
    for more in ([], ["--resume"]):
        done = succeeded(*batch, "--steps", 1, *more)
        assert ", 1 with warnings in " in done.stdout
    warnings = {record["name"]: record["warnings"] for record in records(out / REPORT)}
    assert warnings["cow.obj"] == []
    assert "nothing can move" in "".join(warnings["flat.ply"])


def test_a_format_without_faces_is_written_with_a_warning(cow: Path, tmp_path: Path) -> None:
    batch = ["batch", cow, "--output", tmp_path, "--workers", 1, "--format", "xyz"]
    for arguments, ending in ((batch, "xyz"), (["filter", cow, tmp_path / "one.XYZ"], "XYZ")):
        done = succeeded(*arguments, "--steps", 1)
        assert f"Warning: .{ending} files hold only points; the faces are not" in done.stderr
    assert sorted(contents(tmp_path)) == ["cow.xyz", "one.XYZ"]


def test_a_report_never_replaces_another_file(cow: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    batch = ["batch", cow, "--output", out]
    before = cow.read_bytes()
    assert_fails(command(*batch, "--report", cow), 2, f"{cow} is not a batch report")
    assert_fails(command(*batch, "--report", out / cow.name), 2, "is also an output")
    assert cow.read_bytes() == before
    assert not out.exists()


def test_a_script_is_not_a_recipe(cow: Path, tmp_path: Path) -> None:
    recipe = tmp_path / "recipe.toml"
    arguments = ["--script", tmp_path / "x.mlx", "--save-recipe", recipe]
    done = command("batch", cow, "--output", tmp_path / "out", *arguments)
    assert_fails(done, 2, "--save-recipe")
    assert not recipe.exists()


def test_outputs_next_to_their_inputs_are_not_filtered_again(tmp_path: Path) -> None:
    source = tmp_path / "in"
    make_meshes(source, 1)
    batch = [
        "batch",
        source,
        "--output",
        source,
        "--name",
        "{stem}_x",
        "--steps",
        1,
        "--workers",
        1,
    ]
    succeeded(*batch)
    assert sorted(contents(source)) == ["torus_000.ply", "torus_000_x.ply"]
    done = command(*batch, "--resume")
    assert "0 filtered, 0 failed, 1 already done" in done.stdout
    assert_fails(command("batch", source, "--output", source), 2, "input itself")


def test_a_recipe_gives_the_options_and_the_command_line_overrides_it(
    cow: Path, tmp_path: Path
) -> None:
    recipe, again = tmp_path / "a.toml", tmp_path / "b.toml"
    dry = ["batch", cow, "--output", tmp_path / "out", "--dry-run"]
    given = ["--feature-size", "3%", "--no-reinject-residual", "--steps", 4]
    succeeded(*dry, *given, "--save-recipe", recipe)
    succeeded(*dry, "--recipe", recipe, "--steps", 0, "--save-recipe", again)
    before, after = recipe.read_text(), again.read_text()
    assert 'feature_size = "3%"' in after
    assert "reinject_residual = false" in after
    assert after == before.replace("steps = 4", "steps = 0")


def test_a_script_applies_our_filter_and_meshlabs_own(cow: Path, tmp_path: Path) -> None:
    mesh_set = loaded(cow)
    mesh_set.apply_filter(FILTER, feature_size=percent(8), steps=2)
    mesh_set.apply_coord_laplacian_smoothing(stepsmoothnum=2)
    mesh_set.compute_selection_by_condition_per_vertex(condselect="(z < 0)")
    script, out = tmp_path / "smooth.mlx", tmp_path / "out"
    mesh_set.save_filter_script(str(script))
    succeeded("batch", cow, "--output", out, "--script", script, "--format", "ply", "--workers", 1)
    expected = mesh_set.current_mesh().vertex_matrix()
    V, _ = arrays_of(out / "cow.ply")
    # The script keeps the feature size as a length, and that in single precision.
    assert largest_distance(V, expected) < 1e-6 * diagonal(expected)
    (record,) = records(out / REPORT)
    filters = record["report"]["filters"]
    names = ["Spectral Filter (Fractional)", "Laplacian Smooth", "Conditional Vertex Selection"]
    assert [one["name"] for one in filters] == names == record["options"]["filters"]
    assert filters[0]["report"]["steps"] == 2
    options = ["--script", script, "--steps", 1]
    assert_fails(command("batch", cow, "--output", out, *options), 2, "either a script or options")


def test_the_logs_of_workers_stay_out_of_the_lines_of_verbose(tmp_path: Path) -> None:
    (mesh,) = make_meshes(tmp_path / "in", 1)
    script = tmp_path / "x.mlx"
    script.write_text('<FilterScript><filter name="Laplacian Smooth"/></FilterScript>')
    done = succeeded("batch", mesh, "--output", tmp_path / "out", "--script", script, "-v")
    assert done.stderr == f"[1/1] {mesh.name}: filtered\n"


def test_a_wrong_value_in_a_script_is_named(cow: Path, tmp_path: Path) -> None:
    script = tmp_path / "x.mlx"
    script.write_text(
        '<FilterScript><filter name="Spectral Filter (Fractional)">'
        '<Param name="steps" type="RichInt" value="many"/></filter></FilterScript>'
    )
    done = command("batch", cow, "--output", tmp_path / "out", "--script", script, "--workers", 1)
    assert done.returncode == 1
    assert "filter 1 of the script" in done.stderr
    assert "steps is not a RichInt: 'many'" in done.stderr
    assert "please report it" not in done.stderr


def test_progress_is_shown_on_a_terminal_only(tmp_path: Path) -> None:
    make_meshes(tmp_path / "in", 3)
    arguments = ["batch", str(tmp_path / "in"), "--output", str(tmp_path / "out"), "--workers", "1"]
    arguments += ["--feature-size", "2e"]  # a smaller one is below the edges: a warning
    code, stdout, shown = command_on_terminal(*arguments, "--steps", 1)
    assert code == 0, shown
    assert re.search(rb"[0-3]/3", shown)
    assert b"0 failed" in shown
    assert re.search(rb"files/s, 0:00:[0-9]{2} left", shown)
    assert re.fullmatch(rb"3 filtered, 0 failed in [0-9.]+ s; report: .*\n", stdout)
    code, _, shown = command_on_terminal(*arguments, "--steps", 1, "--resume")
    assert code == 0
    assert b"Comparing files with the report" in shown
    for more in ("--overwrite", "--resume"):
        assert command(*arguments, "--steps", 1, more, "--quiet").stderr == ""
    lines = command(*arguments, "--steps", 1, "--overwrite").stderr.splitlines()
    assert [line[:6] for line in lines] == ["[1/3] ", "[2/3] ", "[3/3] "]
    names = [f"torus_{k:03}.ply: filtered" for k in range(3)]
    assert sorted(line[6:] for line in lines) == names
