"""What a worker does with one file: its processes, second attempts, URLs."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fsspec
import psutil
import pytest
from commands import PRECIOUS, arrays_of
from meshlab_spectral import FilterOptions
from meshlab_spectral.batch import storage
from meshlab_spectral.batch.jobs import Job
from meshlab_spectral.batch.task import run_job
from meshlab_spectral.errors import BatchError
from meshlab_spectral.files.request import Request
from meshlab_spectral.workers.process import NO_LIMITS, JobLimits, MeshLabProcess
from meshlab_spectral.workers.processes import Processes, ProcessesEndedError


@pytest.fixture
def processes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Processes]:
    processes = Processes(1, NO_LIMITS, tmp_path_factory.mktemp("copies"))
    yield processes
    processes.end()


def job_of(source: object, target: object, **more: Any) -> Job:
    options = FilterOptions(steps=1)
    request = Request(Path(), options)
    return Job(str(source), str(target), "name", request, options.as_dict(), **more)


def test_a_filtered_file_is_described_completely(
    processes: Processes, cow: Path, tmp_path: Path
) -> None:
    target = tmp_path / "new" / "folder" / "cow.ply"
    result = run_job(processes, job_of(cow, target))
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
    assert len(result.versions["core"]) == 64
    assert list(target.parent.iterdir()) == [target]


def test_one_process_serves_many_files_until_one_fails(
    processes: Processes, cow: Path, tmp_path: Path
) -> None:
    pids = []
    for name in ("a.ply", "b.ply", "broken", "c.ply"):
        source = cow
        if name == "broken":
            source = tmp_path / "broken.ply"
            source.write_text("no mesh")
        result = run_job(processes, job_of(source, tmp_path / "out" / name))
        assert result.outcome == ("failed" if name == "broken" else "filtered")
        pids += [process.pid for process in processes._idle]
    assert len(pids) == 3
    assert pids[0] == pids[1] != pids[2]


def pid_after(processes: Processes, job: Job) -> int | None:
    """Do a job; the id of the process that waits for the next one."""
    result = run_job(processes, job)
    assert result.outcome == "filtered", result.reason
    return processes._idle[0].pid if processes._idle else None


def test_a_process_is_replaced_after_its_share_of_meshes(
    processes: Processes, cow: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("meshlab_spectral.workers.processes._JOBS_PER_PROCESS", 2)
    pids = [pid_after(processes, job_of(cow, tmp_path / f"{k}.ply")) for k in range(4)]
    assert pids[1] is pids[3] is None
    assert pids[0] != pids[2]


def test_a_process_that_has_grown_is_replaced(
    processes: Processes, cow: Path, tmp_path: Path
) -> None:
    """It has some 80 MiB from the start: more than half of 150 MiB, but not of 1 GiB."""
    job = job_of(cow, tmp_path / "out.ply")
    processes.limits = JobLimits(2**30)
    assert pid_after(processes, job) is not None
    processes.limits = JobLimits(150 * 2**20)
    assert pid_after(processes, job) is None


def test_a_mesh_that_kills_its_process_is_tried_again_once(
    processes: Processes, samples: Path, existing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    killed = []

    def run_and_kill(process: MeshLabProcess, job: dict[str, Any], **options: Any) -> Any:
        def kill(stage: str, fraction: float | None) -> None:
            os.kill(process.pid, signal.SIGKILL)

        killed.append(process.pid)
        return run(process, job, kill, **options)

    run = MeshLabProcess.run
    monkeypatch.setattr(MeshLabProcess, "run", run_and_kill)
    long = Request(Path(), FilterOptions(steps=1000))
    files = str(samples / "bunny.obj"), str(existing)
    result = run_job(processes, Job(*files, "result.ply", long, {}))
    assert result.outcome == "failed"
    assert result.attempts == 2
    assert len(set(killed)) == 2
    assert "SIGKILL" in (result.reason or "")
    assert result.output_sha256 is None


def test_a_process_killed_once_is_not_a_failure(
    processes: Processes, cow: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def kill_first(process: MeshLabProcess, *arguments: Any, **options: Any) -> Any:
        monkeypatch.setattr(MeshLabProcess, "run", run)
        os.kill(process.pid, signal.SIGKILL)
        return run(process, *arguments, **options)

    run = MeshLabProcess.run
    monkeypatch.setattr(MeshLabProcess, "run", kill_first)
    result = run_job(processes, job_of(cow, tmp_path / "cow.ply"))
    assert result.outcome == "filtered", result.reason
    assert result.attempts == 2


def test_the_memory_limit_holds_for_a_job(
    processes: Processes, samples: Path, existing: Path
) -> None:
    processes.limits = JobLimits(60 * 2**20)
    result = run_job(processes, job_of(samples / "bunny.obj", existing))
    assert result.outcome == "failed"
    assert result.attempts == 2
    assert "memory limit" in (result.reason or "")


def test_files_at_urls_are_read_and_written(processes: Processes, cow: Path) -> None:
    memory = fsspec.filesystem("memory")
    memory.pipe("/in/cow.obj", cow.read_bytes())
    memory.pipe("/out/.cow.ply.abcd1234.partial", b"half")
    try:
        storage.tidy("memory://out")
        result = run_job(processes, job_of("memory://in/cow.obj", "memory://out/deep/cow.ply"))
        assert result.outcome == "filtered", result.reason
        assert [Path(path).name for path in memory.find("/out")] == ["cow.ply"]
        assert storage.digest_at("memory://out/deep/cow.ply") == result.output_sha256
        again = run_job(processes, job_of("memory://in/cow.obj", "memory://out/deep/cow.ply"))
        assert again.outcome == "filtered", again.reason  # with the same content
        memory.pipe("/out/deep/cow.ply", PRECIOUS)
        taken = run_job(processes, job_of("memory://in/cow.obj", "memory://out/deep/cow.ply"))
        assert "another program" in (taken.reason or "")
        assert memory.cat("/out/deep/cow.ply") == PRECIOUS
        missing = run_job(processes, job_of("memory://in/none.obj", "memory://out/none.ply"))
        assert missing.outcome == "failed"
        assert "does not exist" in (missing.reason or "")
    finally:
        memory.rm("/in", recursive=True)
        memory.rm("/out", recursive=True)


def test_a_result_at_a_url_is_that_of_a_file(
    processes: Processes, cow: Path, tmp_path: Path
) -> None:
    memory = fsspec.filesystem("memory")
    try:
        at_url = run_job(processes, job_of(cow, "memory://out/cow.ply"))
        in_file = run_job(processes, job_of(cow, tmp_path / "cow.ply"))
        assert at_url.output_sha256 == in_file.output_sha256
        assert len(arrays_of(tmp_path / "cow.ply")[0]) == len(arrays_of(cow)[0])
    finally:
        memory.rm("/out", recursive=True)


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no folder here that even root may not")
def test_a_folder_that_cannot_be_written_to_fails_the_file_alone(
    processes: Processes, cow: Path
) -> None:
    result = run_job(processes, job_of(cow, "/proc/new/cow.ply"))
    assert result.outcome == "failed"
    assert "/proc/new" in (result.reason or "")


def test_a_pipe_named_like_a_mesh_does_not_hang_the_worker(
    processes: Processes, tmp_path: Path
) -> None:
    os.mkfifo(tmp_path / "pipe.ply")
    result = run_job(processes, job_of(tmp_path / "pipe.ply", tmp_path / "out.ply"))
    assert result.outcome == "failed"
    assert "pipe" in (result.reason or "")


def test_a_process_that_dies_between_two_files_is_replaced(
    processes: Processes, cow: Path, tmp_path: Path
) -> None:
    pid = pid_after(processes, job_of(cow, tmp_path / "a.ply"))
    assert pid is not None
    os.kill(pid, signal.SIGKILL)
    os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
    result = run_job(processes, job_of(cow, tmp_path / "b.ply"))
    assert result.attempts == 1
    assert not psutil.pid_exists(pid)  # not even as a zombie


def test_processes_that_do_not_start_are_not_the_fault_of_the_file(
    processes: Processes, cow: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(BatchError, match="with status 1 before it was ready"):
        run_job(processes, job_of(cow, tmp_path / "out" / "cow.ply"))
    assert list((tmp_path / "out").iterdir()) == []


def test_after_their_end_there_are_no_processes(
    processes: Processes, cow: Path, tmp_path: Path
) -> None:
    pid = pid_after(processes, job_of(cow, tmp_path / "a.ply"))
    assert pid is not None
    processes.end()
    assert not psutil.pid_exists(pid)
    with pytest.raises(ProcessesEndedError):
        run_job(processes, job_of(cow, tmp_path / "b.ply"))
    assert [path.name for path in tmp_path.iterdir()] == ["a.ply"]


def test_an_unexpected_error_fails_the_file_alone(
    processes: Processes, cow: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(storage, "digest", lambda path: 1 // 0)
    result = run_job(processes, job_of(cow, tmp_path / "a.ply"))
    assert result.outcome == "failed"
    assert "ZeroDivisionError" in (result.reason or "")
