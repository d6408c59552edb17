"""The functions for scripts: `filter_files` and `filter_mesh`."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import meshlab_spectral
import numpy as np
import psutil
import pytest
from batches import REPORT, alive, contents, make_meshes, records, wait_until
from commands import PRECIOUS, command
from helpers import filter_arrays, percent
from meshlab_spectral import (
    BatchError,
    FilterError,
    InputError,
    OptionError,
    filter_files,
    filter_mesh,
)
from meshlab_spectral.batch import engine
from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.batch.task import run_job


def test_filter_mesh_is_the_filter(decimated: Callable[..., tuple[np.ndarray, np.ndarray]]) -> None:
    V, F = decimated("cow.obj", 2000)
    expected, report = filter_arrays(V, F, feature_size=percent(8), steps=2)
    filtered, same = filter_mesh(V, F, feature_size="8%", steps=2)
    np.testing.assert_array_equal(filtered, expected)
    assert same["step_sizes"] == [0.5, 0.5]
    assert same["max_displacement"] == report["max_displacement"]
    by_length, _ = filter_mesh(V.tolist(), F.tolist(), feature_size=same["feature_size"], steps=2)
    np.testing.assert_allclose(by_length, expected, atol=1e-6)


def test_filter_mesh_names_the_mistake() -> None:
    V, F = np.eye(3), [[0, 1, 2]]
    with pytest.raises(OptionError, match="did you mean feature_size"):
        filter_mesh(V, F, feature_siz="8%")
    with pytest.raises(ValueError, match="vertex 3"):
        filter_mesh(V, [[0, 1, 3]])
    with pytest.raises(FilterError, match="point cloud"):
        filter_mesh(V, np.empty((0, 3), int))


@pytest.fixture(scope="module")
def meshes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("meshes")
    make_meshes(folder, 6)
    return folder


def test_filter_files_gives_a_result_for_every_file(meshes: Path, tmp_path: Path) -> None:
    broken = tmp_path / "broken.ply"
    broken.write_text("no mesh")
    out, by_command = tmp_path / "out", tmp_path / "by_command"
    assert command("batch", meshes, "--output", by_command, "--steps", 1).returncode == 0
    results = list(filter_files([meshes, broken], out, workers=1, steps=1))
    assert sorted(result.outcome for result in results) == ["failed", *["filtered"] * 6]
    assert contents(out) == contents(by_command)
    again = list(filter_files([meshes, broken], out, workers=1, resume=True, steps=1))
    assert sorted(result.outcome for result in again) == [*["already done"] * 6, "failed"]
    assert {result.name: result.output_sha256 for result in again} == {
        result.name: result.output_sha256 for result in results
    }


def test_filter_files_checks_everything_before_it_begins(meshes: Path, tmp_path: Path) -> None:
    with pytest.raises(OptionError, match="did you mean steps"):
        filter_files(meshes, tmp_path / "out", step=1)
    with pytest.raises(OptionError, match="either a script or options"):
        filter_files(meshes, tmp_path / "out", script=tmp_path / "x.mlx", steps=1)
    with pytest.raises(InputError, match="does not exist"):
        filter_files(tmp_path / "none", tmp_path / "out")
    with pytest.raises(OptionError, match="with a scheduler, leave out the number of workers"):
        filter_files(meshes, tmp_path / "out", scheduler="tcp://127.0.0.1:1", workers=1)
    with pytest.raises(InputError, match="--report"):
        filter_files(meshes, "memory://out")
    assert list(tmp_path.iterdir()) == []


def test_an_output_that_appears_before_its_turn_is_kept(meshes: Path, tmp_path: Path) -> None:
    inputs, out = sorted(meshes.iterdir())[:2], tmp_path / "out"
    results = filter_files(inputs, out, workers=1, steps=1)  # planned, not started
    out.mkdir()
    taken = out / inputs[0].name
    taken.write_bytes(PRECIOUS)
    outcomes = {result.name: result.outcome for result in results}
    assert outcomes == {inputs[0].name: "failed", inputs[1].name: "filtered"}
    assert taken.read_bytes() == PRECIOUS


def test_a_file_whose_workers_die_again_and_again_fails_alone(
    meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inputs, out = sorted(meshes.iterdir())[:3], tmp_path / "out"
    deadly = inputs[0].name

    def run_or_die(job: Job) -> FileResult:
        if job.name != deadly:
            return run_job(job)
        wait_until(lambda: len(records(out / REPORT)) == 2)  # of the others
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError("unreachable")

    monkeypatch.setattr(engine, "run_job", run_or_die)
    results = {r.name: r for r in filter_files(inputs, out, workers=1, steps=1)}
    failed = results.pop(deadly)
    assert failed.outcome == "failed"
    assert "ended from outside" in (failed.reason or "")
    assert failed.attempts > 1
    assert [result.outcome for result in results.values()] == ["filtered"] * 2


def test_stopping_the_iteration_ends_the_workers(meshes: Path, tmp_path: Path) -> None:
    this = psutil.Process()
    before = this.children(recursive=True)
    results = filter_files(meshes, tmp_path / "out", workers=1, steps=1)
    next(results)
    started = [child for child in this.children(recursive=True) if child not in before]
    workers = [child for child in started if "resource_tracker" not in " ".join(child.cmdline())]
    assert len(workers) >= 2  # a worker, and MeshLab's process in it
    results.close()
    wait_until(lambda: not alive(workers))
    assert not list((tmp_path / "out").glob(".*"))


UNGUARDED = """
import sys
from meshlab_spectral import filter_files
list(filter_files(sys.argv[1], sys.argv[2], workers=1, steps=1))
"""


def test_a_script_that_workers_cannot_import_is_refused_with_the_remedy(
    meshes: Path, tmp_path: Path
) -> None:
    script = tmp_path / "script.py"
    script.write_text(UNGUARDED)
    done = subprocess.run(
        [sys.executable, str(script), str(meshes), str(tmp_path / "out")],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert "BatchError" in last
    assert 'if __name__ == "__main__":' in last


def test_workers_that_do_not_start_leave_ctrl_c_as_it_was(
    meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(**_: object) -> None:
        raise RuntimeError("no port is free")

    monkeypatch.setattr(engine, "LocalCluster", fail)
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    with pytest.raises(BatchError, match="no port"):
        list(filter_files(meshes, tmp_path / "out", workers=1, steps=1))
    assert signal.pthread_sigmask(signal.SIG_BLOCK, []) == before


def test_all_public_names_exist() -> None:
    for name in meshlab_spectral.__all__:
        assert hasattr(meshlab_spectral, name)


def test_workers_leave_an_interruption_to_the_program() -> None:
    with engine.local_workers(1) as client:
        handlers = client.run(signal.getsignal, signal.SIGINT)
    assert list(handlers.values()) == [signal.SIG_IGN]
