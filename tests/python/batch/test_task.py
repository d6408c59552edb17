"""What a worker does with one file: its processes, second attempts, URLs."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fsspec
import pytest
from commands import PRECIOUS, arrays_of
from meshlab_spectral import FilterOptions
from meshlab_spectral.batch import storage
from meshlab_spectral.batch.jobs import Job
from meshlab_spectral.batch.processes import processes
from meshlab_spectral.batch.task import run_job
from meshlab_spectral.process.parent import MeshLabProcess


@pytest.fixture(autouse=True)
def _no_process_left() -> Iterator[None]:
    yield
    processes.end()


def job_of(source: object, target: object, **more: Any) -> Job:
    options = FilterOptions(steps=1).as_dict()
    work = {"task": "filter", "options": options}
    return Job(str(source), str(target), "name", work, options, **more)


def test_a_filtered_file_is_described_completely(cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "new" / "folder" / "cow.ply"
    result = run_job(job_of(cow, target))
    assert result.outcome == "filtered", result.reason
    assert result.reason is None
    assert result.input_sha256 == storage.digest(cow)
    assert result.output_sha256 == storage.digest(target)
    assert result.report is not None
    assert result.report["steps"] == 1
    assert result.options["steps"] == 1
    assert result.attempts == 1
    assert 0 < result.seconds < 60
    assert 30e6 < (result.peak_memory or 0) < 1e9
    assert len(result.versions["plugin"]) == 64
    assert list(target.parent.iterdir()) == [target]


def test_one_process_serves_many_files_until_one_fails(cow: Path, tmp_path: Path) -> None:
    pids = []
    for name in ("a.ply", "b.ply", "broken", "c.ply"):
        source = cow
        if name == "broken":
            source = tmp_path / "broken.ply"
            source.write_text("no mesh")
        result = run_job(job_of(source, tmp_path / "out" / name))
        assert result.outcome == ("failed" if name == "broken" else "filtered")
        pids += [process.pid for process in processes._idle]
    assert len(pids) == 3
    assert pids[0] == pids[1] != pids[2]


def pid_after(job: Job, **limits: int) -> int | None:
    """Do a job; the id of the process that waits for the next one."""
    result = run_job(job, **limits)
    assert result.outcome == "filtered", result.reason
    return processes._idle[0].pid if processes._idle else None


def test_a_process_is_replaced_after_its_share_of_meshes(
    cow: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("meshlab_spectral.batch.processes._JOBS_PER_PROCESS", 2)
    pids = [pid_after(job_of(cow, tmp_path / f"{k}.ply")) for k in range(4)]
    assert pids[1] is pids[3] is None
    assert pids[0] != pids[2]


def test_a_process_that_has_grown_is_replaced(cow: Path, tmp_path: Path) -> None:
    """It has some 80 MiB from the start: more than half of 150 MiB, but not of 1 GiB."""
    job = job_of(cow, tmp_path / "out.ply")
    assert pid_after(job, memory_limit=2**30) is not None
    assert pid_after(job, memory_limit=150 * 2**20) is None


def test_a_mesh_that_kills_its_process_is_tried_again_once(
    samples: Path, existing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    killed = []

    def run_and_kill(process: MeshLabProcess, *arguments: Any, **options: Any) -> Any:
        timer = threading.Timer(0.3, os.kill, (process.pid, signal.SIGKILL))
        timer.start()
        killed.append(process.pid)
        return run(process, *arguments, **options)

    run = MeshLabProcess.run
    monkeypatch.setattr(MeshLabProcess, "run", run_and_kill)
    long = FilterOptions(steps=1000).as_dict()
    work = {"task": "filter", "options": long}
    result = run_job(Job(str(samples / "bunny.obj"), str(existing), "result.ply", work, long))
    assert result.outcome == "failed"
    assert result.attempts == 2
    assert len(set(killed)) == 2
    assert "SIGKILL" in (result.reason or "")
    assert result.output_sha256 is None


def test_a_process_killed_once_is_not_a_failure(
    cow: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def kill_first(process: MeshLabProcess, *arguments: Any, **options: Any) -> Any:
        monkeypatch.setattr(MeshLabProcess, "run", run)
        os.kill(process.pid, signal.SIGKILL)
        return run(process, *arguments, **options)

    run = MeshLabProcess.run
    monkeypatch.setattr(MeshLabProcess, "run", kill_first)
    result = run_job(job_of(cow, tmp_path / "cow.ply"))
    assert result.outcome == "filtered", result.reason
    assert result.attempts == 2


def test_the_memory_limit_holds_for_a_job(samples: Path, existing: Path) -> None:
    result = run_job(job_of(samples / "bunny.obj", existing), memory_limit=60 * 2**20)
    assert result.outcome == "failed"
    assert result.attempts == 2
    assert "memory limit" in (result.reason or "")


def test_files_at_urls_are_read_and_written(cow: Path) -> None:
    memory = fsspec.filesystem("memory")
    memory.pipe("/in/cow.obj", cow.read_bytes())
    memory.pipe("/out/.cow.ply.abcd1234.partial", b"half")
    try:
        storage.tidy("memory://out")
        result = run_job(job_of("memory://in/cow.obj", "memory://out/deep/cow.ply"))
        assert result.outcome == "filtered", result.reason
        assert [Path(path).name for path in memory.find("/out")] == ["cow.ply"]
        assert storage.digest_at("memory://out/deep/cow.ply") == result.output_sha256
        again = run_job(job_of("memory://in/cow.obj", "memory://out/deep/cow.ply"))
        assert again.outcome == "filtered", again.reason  # with the same content
        memory.pipe("/out/deep/cow.ply", PRECIOUS)
        taken = run_job(job_of("memory://in/cow.obj", "memory://out/deep/cow.ply"))
        assert "another program" in (taken.reason or "")
        assert memory.cat("/out/deep/cow.ply") == PRECIOUS
        missing = run_job(job_of("memory://in/none.obj", "memory://out/none.ply"))
        assert missing.outcome == "failed"
        assert "does not exist" in (missing.reason or "")
    finally:
        memory.rm("/in", recursive=True)
        memory.rm("/out", recursive=True)


def test_a_result_at_a_url_is_that_of_a_file(cow: Path, tmp_path: Path) -> None:
    memory = fsspec.filesystem("memory")
    try:
        at_url = run_job(job_of(cow, "memory://out/cow.ply"))
        in_file = run_job(job_of(cow, tmp_path / "cow.ply"))
        assert at_url.output_sha256 == in_file.output_sha256
        assert len(arrays_of(tmp_path / "cow.ply")[0]) == len(arrays_of(cow)[0])
    finally:
        memory.rm("/out", recursive=True)


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no folder here that even root may not")
def test_a_folder_that_cannot_be_written_to_fails_the_file_alone(cow: Path) -> None:
    result = run_job(job_of(cow, "/proc/new/cow.ply"))
    assert result.outcome == "failed"
    assert "/proc/new" in (result.reason or "")


def test_a_pipe_named_like_a_mesh_does_not_hang_the_worker(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.ply")
    result = run_job(job_of(tmp_path / "pipe.ply", tmp_path / "out.ply"))
    assert result.outcome == "failed"
    assert "pipe" in (result.reason or "")
