"""Arrays, and commands on files that are patched, need no pymeshlab."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import command, messages_in
from format_samples import SAMPLES, Sample

pytestmark = pytest.mark.slow

# Imported by every Python that starts, child processes of commands among them.
WITHOUT = "import sys\nsys.modules['pymeshlab'] = None\n"


@pytest.fixture
def without_meshlab(tmp_path: Path) -> dict[str, str]:
    folder = tmp_path / "site"
    folder.mkdir()
    (folder / "sitecustomize.py").write_text(WITHOUT)
    return {"PYTHONPATH": str(folder)}


@pytest.mark.parametrize(
    ("task", "sample"),
    [*(("filter", one) for one in SAMPLES)],
)
def test_a_patched_file_is_filtered(
    task: str, sample: Sample, tmp_path: Path, without_meshlab: dict[str, str]
) -> None:
    source = tmp_path / sample.name
    sample.write(source)
    target = tmp_path / "out" / sample.name
    target.parent.mkdir()
    done = command(task, source, target, **without_meshlab)
    assert done.returncode == 0, done.stderr
    before, after = sample.read(source)["coordinates"], sample.read(target)["coordinates"]
    assert np.shape(before) == np.shape(after)
    assert not np.array_equal(before, after)


@pytest.mark.parametrize(
    ("task", "sample"),
    [*(("info", one) for one in SAMPLES), ("spectrum", SAMPLES[0])],
)
def test_a_patched_file_is_measured(
    task: str, sample: Sample, tmp_path: Path, without_meshlab: dict[str, str]
) -> None:
    source = tmp_path / sample.name
    sample.write(source)
    done = command(task, source, "--json", **without_meshlab)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)


def test_a_file_is_denoised(tmp_path: Path, without_meshlab: dict[str, str]) -> None:
    source = tmp_path / SAMPLES[0].name
    SAMPLES[0].write(source)
    options = ["--noise-height", "0.3e"]
    done = command("denoise", source, tmp_path / "out.ply", *options, **without_meshlab)
    assert done.returncode == 0, done.stderr


def test_a_batch_runs(tmp_path: Path, without_meshlab: dict[str, str]) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    for sample in SAMPLES:
        sample.write(folder / sample.name)
    done = command("batch", folder, "--output", tmp_path / "out", "--workers", 1, **without_meshlab)
    assert done.returncode == 0, done.stderr


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
