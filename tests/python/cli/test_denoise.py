"""The command `meshlab-spectral denoise`, and batches with a recipe for it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from batches import REPORT, contents, make_meshes, records
from commands import arrays_of, command, messages_in, succeeded
from helpers import loaded
from meshlab_spectral import DenoiseOptions
from meshlab_spectral.files.recipe import load_recipe
from numpy.testing import assert_array_equal

FILTER = "apply_coord_spectral_denoise"


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    """A noisy torus."""
    return make_meshes(tmp_path, 1, rings=48)[0]


def denoised(path: Path, noise_height: float = 0.0) -> np.ndarray:
    """Positions that pymeshlab computes; at a height of 0 it measures the height itself."""
    mesh_set = loaded(path)
    mesh_set.apply_filter(FILTER, noise_height=pymeshlab.PureValue(noise_height))
    return mesh_set.current_mesh().vertex_matrix().copy()


def recipe_in(folder: Path, text: str) -> Path:
    path = folder / "denoise.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_output_is_what_pymeshlab_computes(scan: Path, tmp_path: Path) -> None:
    target = tmp_path / "clean.ply"
    done = succeeded("denoise", scan, target)
    assert messages_in(done.stderr) == ""
    (V, F), (noisy, faces) = arrays_of(target), arrays_of(scan)
    assert_array_equal(V, denoised(scan))
    assert_array_equal(F, faces)
    assert np.abs(V - noisy).max() > 0.01


def test_json_is_one_object_with_report_options_and_versions(scan: Path, tmp_path: Path) -> None:
    target = tmp_path / "clean.ply"
    done = succeeded("denoise", scan, target, "--json")
    assert done.stdout.count("\n") == 1
    record = json.loads(done.stdout)
    assert (record["input"], record["output"]) == (str(scan), str(target))
    assert record["options"] == DenoiseOptions().as_dict()
    report = record["report"]
    assert report["noise_height"] == report["estimated_noise_height"]
    assert report["noise_height"] == pytest.approx(0.02, rel=0.3)
    assert 0 < report["rms_displacement"] <= report["max_displacement"]
    assert {"meshlab_spectral", "pymeshlab", "python"} <= record["versions"].keys()


def test_a_height_is_given_in_mean_edges(scan: Path, tmp_path: Path) -> None:
    target = tmp_path / "clean.ply"
    done = command("denoise", scan, target, "--noise-height", "0.2e", "--json")
    record = json.loads(done.stdout)
    assert record["options"]["noise_height"] == "0.2e"
    V, F = arrays_of(scan)
    height = 0.2 * np.linalg.norm(V[F] - V[np.roll(F, 1, axis=1)], axis=2).mean()
    assert record["report"]["noise_height"] == pytest.approx(height, rel=1e-6)
    assert_array_equal(arrays_of(target)[0], denoised(scan, height))


@pytest.mark.slow
def test_a_recipe_denoises_a_folder(tmp_path: Path) -> None:
    source, out = tmp_path / "scans", tmp_path / "clean"
    scans = make_meshes(source, 2, rings=48)
    recipe = recipe_in(tmp_path, "[denoise]\n")
    batch = ["batch", source, "--output", out, "--recipe", recipe, "--workers", 1]
    done = succeeded(*batch)
    assert "2 filtered, 0 failed" in done.stdout
    for scan in scans:
        assert_array_equal(arrays_of(out / scan.name)[0], denoised(scan))
    for record in records(out / REPORT):
        assert record["options"] == DenoiseOptions().as_dict()
        assert record["report"]["noise_height"] > 0
    before = contents(out)
    assert "2 already done" in command(*batch, "--resume").stdout
    # Another option is another result.
    recipe_in(tmp_path, "[denoise]\nstrength = 0.5\n")
    assert "2 filtered, 0 failed" in command(*batch, "--resume").stdout
    after = contents(out)
    assert after.keys() == before.keys()
    assert all(after[name] != before[name] for name in after)


def test_a_dry_run_lists_the_outputs_and_saves_the_whole_recipe(scan: Path, tmp_path: Path) -> None:
    recipe, saved = recipe_in(tmp_path, '[denoise]\nnoise_height = "0.2e"\n'), tmp_path / "a.toml"
    out = tmp_path / "clean"
    arguments = ["--recipe", recipe, "--dry-run", "--save-recipe", saved]
    done = succeeded("batch", scan, "--output", out, *arguments)
    assert done.stdout == f"{scan} -> {out / scan.name}\n"
    assert not out.exists()
    text = saved.read_text(encoding="utf-8")
    assert text.startswith("[denoise]\n")
    assert 'noise_height = "0.2e"' in text
    assert "strength = 1.0" in text


def test_a_batch_denoises_without_a_recipe(scan: Path, tmp_path: Path) -> None:
    out, saved = tmp_path / "clean", tmp_path / "a.toml"
    succeeded("batch", scan, "--output", out, "--denoise", "--save-recipe", saved)
    assert_array_equal(arrays_of(out / scan.name)[0], denoised(scan))
    assert load_recipe(saved) == (DenoiseOptions, DenoiseOptions().as_dict())


def test_a_batch_denoises_with_every_option_of_denoise(scan: Path, tmp_path: Path) -> None:
    given = {"strength": 0.5, "noise_height": "0.2e", "noise_size": "0.5e", "boundary": "fixed"}
    spelled = [f"--{name.replace('_', '-')}={value}" for name, value in given.items()]
    out, one, saved = tmp_path / "clean", tmp_path / "one.ply", tmp_path / "a.toml"
    options = [*spelled, "--no-keep-creases", "--save-recipe", saved]
    done = succeeded("batch", scan, "--output", out, "--denoise", *options)
    expected = {**DenoiseOptions().as_dict(), **given, "keep_creases": False}
    assert load_recipe(saved) == (DenoiseOptions, expected)
    # Options of the command line come before those of the recipe, in both commands.
    done = command("denoise", scan, one, "--recipe", saved, "--json")
    assert json.loads(done.stdout)["options"] == expected
    assert one.read_bytes() == (out / scan.name).read_bytes()
    again = ["--output", tmp_path / "again", "--recipe", saved, "--strength", 2]
    succeeded("batch", scan, *again, "--denoise")
    (record,) = records(tmp_path / "again" / REPORT)
    assert record["options"] == {**expected, "strength": 2.0}
