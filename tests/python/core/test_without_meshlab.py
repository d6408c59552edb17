"""Arrays, and commands on files that are patched, need no pymeshlab."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import command, messages_in, succeeded
from format_samples import SAMPLES

pytestmark = pytest.mark.slow

# Imported by every Python that starts, child processes of commands among them.
WITHOUT = "import sys\nsys.modules['pymeshlab'] = None\n"


@pytest.fixture
def without_meshlab(tmp_path: Path) -> dict[str, str]:
    folder = tmp_path / "site"
    folder.mkdir()
    (folder / "sitecustomize.py").write_text(WITHOUT)
    return {"PYTHONPATH": str(folder)}


def test_a_batch_filters_every_file_that_is_patched(
    tmp_path: Path, without_meshlab: dict[str, str]
) -> None:
    source, target = tmp_path / "in", tmp_path / "out"
    source.mkdir()
    names = [f"{number} {sample.name}" for number, sample in enumerate(SAMPLES)]
    for name, sample in zip(names, SAMPLES, strict=True):
        sample.write(source / name)
    succeeded("batch", source, "--output", target, "--workers", 1, **without_meshlab)
    for name, sample in zip(names, SAMPLES, strict=True):
        before, after = (sample.read(folder / name)["coordinates"] for folder in (source, target))
        assert np.shape(before) == np.shape(after)
        assert not np.array_equal(before, after)


@pytest.mark.parametrize(
    "words",
    [
        ("filter", "mesh", "out.ply"),
        ("denoise", "mesh", "out.ply", "--noise-height", "0.3e"),
        ("info", "mesh", "--json"),
        ("spectrum", "mesh", "--json"),
    ],
)
def test_a_command_runs(
    words: tuple[str, ...], tmp_path: Path, without_meshlab: dict[str, str]
) -> None:
    SAMPLES[0].write(tmp_path / "mesh.ply")
    arguments = ["mesh.ply" if word == "mesh" else word for word in words]
    succeeded(*arguments, folder=tmp_path, **without_meshlab)


def test_what_needs_meshlab_says_what_to_install(
    tmp_path: Path, without_meshlab: dict[str, Any]
) -> None:
    sample = SAMPLES[0]
    source = tmp_path / sample.name
    sample.write(source)
    needing = [
        ("filter", "other.dae"),
        ("filter", "other.dae", "--dry-run"),
        ("filter", "details.ply", "--preset", "extract-details"),
        ("denoise", "heights.ply", "--store-noise-height"),
    ]
    for verb, name, *more in needing:
        done = command(verb, source, tmp_path / name, *more, **without_meshlab)
        assert done.returncode != 0
        assert "needs pymeshlab: pip install 'meshlab-spectral[meshlab]'" in messages_in(
            done.stderr
        )
