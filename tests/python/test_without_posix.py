"""The package imports nothing that only POSIX systems have; `--without-posix` runs all tests so."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from batches import make_meshes
from commands import succeeded

FOLDER = str(Path(__file__).parent / "without_posix")


@pytest.mark.parametrize("importer", ["meshlab_spectral.files", "somebody_else"])
def test_only_the_package_is_refused_posix_modules(importer: str) -> None:
    code = f"exec('import fcntl', {{'__package__': {importer!r}}})"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={"PYTHONPATH": FOLDER},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    refused = importer.startswith("meshlab_spectral")
    assert ("which Windows has not" in done.stderr) == refused
    assert (done.returncode != 0) == refused


def test_a_file_and_a_batch_are_filtered_without_posix(tmp_path: Path) -> None:
    (mesh,) = make_meshes(tmp_path / "in", 1)
    succeeded("filter", mesh, tmp_path / "out.ply", PYTHONPATH=FOLDER)
    succeeded("batch", tmp_path / "in", "--output", tmp_path / "out", PYTHONPATH=FOLDER)
    assert (tmp_path / "out" / mesh.name).read_bytes() == (tmp_path / "out.ply").read_bytes()
