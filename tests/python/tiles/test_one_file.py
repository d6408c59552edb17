"""`filter_file`, `denoise_file` and `denoise_files`: what the commands of these names do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from meshlab_spectral import (
    Cancelled,
    InputError,
    denoise_file,
    denoise_files,
    denoise_mesh,
    examples,
    filter_file,
    filter_mesh,
    filter_preset,
)
from meshlab_spectral.files.meshes import load_arrays


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    path = tmp_path / "scan.ply"
    examples.save(path, *examples.scan())
    return path


def test_a_file_is_filtered_as_its_arrays(scan: Path, tmp_path: Path) -> None:
    V, F = examples.scan()
    stages: list[str] = []
    out = tmp_path / "out.ply"
    report = filter_file(
        scan, out, feature_size="8e", progress=lambda stage, _: stages.append(stage)
    )
    expected, told = filter_mesh(V, F, feature_size="8e")
    np.testing.assert_allclose(load_arrays(out)[0], expected, rtol=0, atol=1e-12)
    assert report["max_displacement"] == pytest.approx(told["max_displacement"])
    assert len(set(stages)) > 1
    denoised = denoise_file(str(scan), str(out), overwrite=True)
    assert denoised["summary"] == denoise_mesh(V, F)[1]["summary"]


def test_files_in_the_way_and_cancelled_runs_leave_what_was_there(
    scan: Path, tmp_path: Path
) -> None:
    before, out = scan.read_bytes(), tmp_path / "out.ply"
    with pytest.raises(InputError, match="is the input itself"):
        filter_file(scan, scan, filter_preset("print"), overwrite=True)
    out.write_text("precious")
    with pytest.raises(InputError, match="overwrite=True"):
        denoise_file(scan, out)
    with pytest.raises(Cancelled):
        denoise_file(scan, out, overwrite=True, progress=lambda *_: False)
    assert (scan.read_bytes(), out.read_text()) == (before, "precious")
    assert {path.name for path in tmp_path.iterdir()} == {"scan.ply", "out.ply"}


def test_many_files_are_denoised_as_each(scan: Path, tmp_path: Path) -> None:
    (result,) = denoise_files(scan, tmp_path / "clean", workers=1, strength=0.5)
    assert result.outcome == "filtered", result.reason
    denoise_file(scan, tmp_path / "one.ply", strength=0.5)
    written = tmp_path / "clean" / "scan.ply"
    assert written.read_bytes() == (tmp_path / "one.ply").read_bytes()


@pytest.mark.parametrize("make", [examples.scan, examples.part, examples.terrain])
def test_examples_are_surfaces_with_the_noise_that_they_name(make: object) -> None:
    assert callable(make)
    V, F = make(0.25, seed=1)
    truth, same = make(0.0)
    np.testing.assert_array_equal(F, same)
    edges = np.sort(np.vstack([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    _, faces = np.unique(edges, axis=0, return_counts=True)
    assert set(faces.tolist()) <= ({1, 2} if make is examples.terrain else {2})
    edge = np.linalg.norm(truth[F[:, 1]] - truth[F[:, 0]], axis=1).mean()
    height = np.linalg.norm(V - truth, axis=1)
    assert np.sqrt((height**2).mean()) == pytest.approx(0.25 * edge, rel=0.03)
    W, _ = denoise_mesh(V, F)
    assert np.linalg.norm(W - truth, axis=1).mean() < 0.7 * height.mean()
