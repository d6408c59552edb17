"""The functions for scripts: `filter_files` and `filter_mesh`."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import fsspec
import meshlab_spectral
import numpy as np
import psutil
import pytest
from batches import REPORT, contents, make_meshes, records, wait_until
from commands import PRECIOUS, is_worker, python, succeeded
from helpers import filter_arrays, percent
from meshlab_spectral import (
    BatchError,
    FilterError,
    InputError,
    OptionError,
    filter_files,
    filter_mesh,
)
from meshlab_spectral.workers.process import Answer, MeshLabProcess
from shared_types import Decimated


def test_filter_mesh_is_the_filter(decimated: Decimated) -> None:
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
    succeeded("batch", meshes, "--output", by_command, "--steps", 1)
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


def test_a_file_that_kills_its_process_again_and_again_fails_alone(
    meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    large = make_meshes(tmp_path / "in", 1, rings=100)  # a second of work: killed before its end
    inputs = [*large, *sorted(meshes.iterdir())[1:3]]

    def run_and_die(process: MeshLabProcess, job: dict[str, Any], **options: Any) -> Answer:
        def kill(stage: str, fraction: float | None) -> None:
            if job["request"].source == inputs[0]:
                os.kill(process.pid, signal.SIGKILL)

        return run(process, job, kill, **options)

    run = MeshLabProcess.run
    monkeypatch.setattr(MeshLabProcess, "run", run_and_die)
    results = {r.name: r for r in filter_files(inputs, tmp_path / "out", workers=1, steps=100)}
    failed = results.pop(inputs[0].name)
    assert failed.outcome == "failed"
    assert "SIGKILL" in (failed.reason or "")
    assert failed.attempts == 2
    assert [result.outcome for result in results.values()] == ["filtered"] * 2
    assert children() == []


def children() -> list[psutil.Process]:
    """Return the child processes of this one, also those that have ended but are not reaped."""
    return [one for one in psutil.Process().children(recursive=True) if not is_worker(one.pid)]


def test_stopping_the_iteration_ends_the_workers(meshes: Path, tmp_path: Path) -> None:
    results = filter_files(meshes, tmp_path / "out", workers=1, steps=1)
    next(results)
    assert len(children()) == 1
    results.close()
    assert children() == []
    assert not list((tmp_path / "out").glob(".*"))


def test_what_is_finished_is_recorded_while_the_program_is_busy_with_a_result(
    meshes: Path, tmp_path: Path
) -> None:
    results = filter_files(meshes, tmp_path / "out", workers=1, steps=1)
    first = next(results)
    wait_until(lambda: len(records(tmp_path / "out" / REPORT)) == 6)
    names = [result.name for result in (first, *results)]
    assert sorted(names) == sorted(path.name for path in meshes.iterdir())


def test_an_error_of_the_program_ends_the_workers(meshes: Path, tmp_path: Path) -> None:
    def use_first() -> None:
        for _ in filter_files(meshes, tmp_path / "out", workers=2, steps=1):
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        use_first()
    assert children() == []


UNGUARDED = """
import sys
from meshlab_spectral import filter_files
for result in filter_files(sys.argv[1], sys.argv[2], workers=1, steps=1):
    print(result.outcome)
"""


def test_a_script_needs_no_guard(meshes: Path, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(UNGUARDED)
    done = python(script, meshes, tmp_path / "out")
    assert done.stdout.split() == ["filtered"] * 6, done.stderr


UNFINISHED = """
import sys
from meshlab_spectral import filter_files
results = filter_files(sys.argv[1], sys.argv[2], workers=2, steps=1000)
print(next(results).outcome)
"""


def test_a_program_that_ends_before_its_batch_does_so_at_once(tmp_path: Path) -> None:
    (small,) = make_meshes(tmp_path / "in", 1)
    small.rename(small.with_name("a.ply"))
    make_meshes(tmp_path / "in", 2, rings=300)  # minutes of work, on any machine
    begin = time.monotonic()
    done = python("-c", UNFINISHED, tmp_path / "in", tmp_path / "out")
    assert (done.returncode, done.stdout, done.stderr) == (0, "filtered\n", "")
    assert time.monotonic() - begin < 15
    assert sorted(contents(tmp_path / "out")) == ["a.ply"]


def test_batches_in_threads_give_what_one_after_the_other_gives(
    meshes: Path, tmp_path: Path
) -> None:
    def run(name: str) -> list[str]:
        results = filter_files(meshes, tmp_path / name, workers=2, steps=1)
        return [result.outcome for result in results]

    assert run("alone") == ["filtered"] * 6
    with ThreadPoolExecutor() as pool:
        assert list(pool.map(run, ["a", "b", "c"])) == [["filtered"] * 6] * 3
    for name in ("a", "b", "c"):
        assert contents(tmp_path / name) == contents(tmp_path / "alone")
    assert children() == []


def test_workers_that_do_not_start_end_the_batch_soon_with_the_cause(
    meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    child, starts = tmp_path / "child", tmp_path / "starts"
    child.write_text(f"#!/bin/sh\necho >>{starts}\necho no module named numpy >&2\nexit 3\n")
    child.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(child))
    with pytest.raises(BatchError, match=r"with status 3 before .*no module named numpy"):
        list(filter_files(meshes, tmp_path / "out", workers=1, steps=1))
    assert len(starts.read_text()) <= 4  # of 6 files
    assert records(tmp_path / "out" / REPORT) == []
    monkeypatch.setattr(sys, "executable", str(tmp_path / "none"))
    with pytest.raises(BatchError, match="cannot be started"):
        list(filter_files(meshes, tmp_path / "out", workers=1, steps=1))
    assert children() == []


def test_a_report_that_another_batch_is_writing_is_left_to_it(meshes: Path, tmp_path: Path) -> None:
    first = filter_files(meshes, tmp_path / "a", workers=1, report=tmp_path / "report", steps=1)
    next(first)
    second = filter_files(meshes, tmp_path / "b", workers=1, report=tmp_path / "report", steps=1)
    with pytest.raises(BatchError, match="another batch"):
        next(second)
    assert len(list(first)) == 5
    assert len(records(tmp_path / "report")) == 6
    assert not (tmp_path / "b").exists()


def test_a_slow_transfer_does_not_hold_up_the_end(
    meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started, released = threading.Event(), threading.Event()

    def get_slowly(fs: Any, source: str, target: str) -> None:
        if started.is_set():
            Path(target).write_bytes(b"half")
            released.wait(60)
        started.set()
        shutil.copy(sorted(meshes.iterdir())[0], target)

    memory = fsspec.filesystem("memory")
    monkeypatch.setattr(type(memory), "get_file", get_slowly)
    monkeypatch.setattr("meshlab_spectral.workers.pool._SECONDS_TO_END", 0.5)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    (tmp_path / "tmp").mkdir()
    for name in ("a.ply", "b.ply", "c.ply"):
        memory.pipe(f"/in/{name}", b"")
    try:
        results = filter_files("memory://in", tmp_path / "out", workers=1, steps=1)
        assert next(results).outcome == "filtered"
        begin = time.monotonic()
        results.close()
        assert time.monotonic() - begin < 5
        assert list((tmp_path / "tmp").iterdir()) == []
    finally:
        released.set()
        memory.rm("/in", recursive=True)
    assert len(records(tmp_path / "out" / REPORT)) == 1


def test_all_public_names_exist() -> None:
    for name in meshlab_spectral.__all__:
        assert hasattr(meshlab_spectral, name)
