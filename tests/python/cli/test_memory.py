"""MESHLAB_SPECTRAL_MEMORY counts in every command that works on a mesh."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from batches import REPORT, make_meshes, records
from commands import assert_fails, command, succeeded

MEBIBYTE = 2**20
# Less than MeshLab's process has at its start.
TOO_LITTLE = {"MESHLAB_SPECTRAL_MEMORY": str(30 * MEBIBYTE)}
ENOUGH = {"MESHLAB_SPECTRAL_MEMORY": "4e9"}
REMEDY = "raise or unset the environment variable MESHLAB_SPECTRAL_MEMORY"

OF_ONE_MESH = {
    "info": [],
    "filter": ["out.ply"],
    "denoise": ["out.ply"],
    "spectrum": ["-o", "out.png"],
    "basis": ["-o", "out.npz"],
    "texture": ["--waviness", "30%"],
    "compare": ["in/torus_000.ply"],
}
OF_MANY = {"batch": ["--output", "out"], "spectra": ["--output", "out.csv"]}
NOT_NUMBERS = ["", "0", "-1", "nan"]


@pytest.fixture
def mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return make_meshes(tmp_path / "in", 1)[0]


@pytest.mark.parametrize("name", OF_ONE_MESH)
def test_a_command_for_one_mesh_keeps_to_the_limit(name: str, mesh: Path) -> None:
    arguments = [name, mesh, *OF_ONE_MESH[name]]
    assert_fails(command(*arguments, **TOO_LITTLE), 1, "more than 30 MiB of memory", REMEDY)
    assert not list(Path().glob("out*"))
    succeeded(*arguments, **ENOUGH)


def test_a_filter_is_refused_before_it_takes_the_memory(samples: Path, tmp_path: Path) -> None:
    """The plugin knows the limit, too: it says what it would need."""
    arguments = ["filter", samples / "bunny.obj", tmp_path / "out.ply", "--spectrum", "truncated"]
    more = ["--basis-size", "4000", "--steps", "1"]
    limit = str(400 * MEBIBYTE)
    done = command(*arguments, *more, MESHLAB_SPECTRAL_MEMORY=limit)
    assert_fails(done, 1, "more than 400 MiB of memory", REMEDY, "need about", "are free")


@pytest.mark.parametrize("name", OF_MANY)
def test_a_command_for_many_meshes_keeps_to_the_limit(name: str, mesh: Path) -> None:
    arguments = [name, mesh, *OF_MANY[name], "--workers", "1"]
    failed = command(*arguments, **TOO_LITTLE)
    assert failed.returncode == 1, failed.stderr
    assert "more than 30 MiB of memory" in failed.stderr
    assert REMEDY in failed.stderr
    done = command(*arguments, "--memory-limit", "4GB", "--resume", **TOO_LITTLE)
    assert done.returncode == 0, "the option wins:\n" + done.stderr


def test_an_option_of_a_batch_wins_over_the_variable(mesh: Path) -> None:
    """A variable that does not count is not even read."""
    arguments = ["batch", mesh, *OF_MANY["batch"], "--workers", "1", "--memory-limit", "90MB"]
    done = command(*arguments, MESHLAB_SPECTRAL_MEMORY="not even a number")
    (outcome,) = records(Path("out") / REPORT)
    assert "MESHLAB_SPECTRAL_MEMORY" not in done.stderr + json.dumps(outcome)


@pytest.mark.parametrize(
    ("name", "value"),
    [(name, "4XB") for name in (*OF_ONE_MESH, *OF_MANY)] + [("info", one) for one in NOT_NUMBERS],
)
def test_a_limit_that_is_no_number_is_refused(name: str, value: str, mesh: Path) -> None:
    arguments = OF_ONE_MESH.get(name) or OF_MANY.get(name) or []
    done = command(name, mesh, *arguments, MESHLAB_SPECTRAL_MEMORY=value)
    told = f"the environment variable MESHLAB_SPECTRAL_MEMORY = {value}: give a number of bytes"
    assert_fails(done, 2, told, "such as 4e9 or 4GB, or unset it")
    assert not list(Path().glob("out*"))
