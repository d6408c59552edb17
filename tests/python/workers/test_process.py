"""MeshLab's process, seen from its parent: limits, its death and its parent's."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import Any

import psutil
import pytest
from batches import alive, wait_until
from commands import python
from meshlab_spectral import FilterOptions
from meshlab_spectral.errors import (
    MemoryLimitError,
    ProcessDiedError,
    ProcessStartError,
    TimeLimitError,
)
from meshlab_spectral.files.request import Request
from meshlab_spectral.workers.process import JobLimits, MeshLabProcess, as_text


def work(source: Path, tmp_path: Path, steps: int = 1000, **more: Any) -> dict[str, Any]:
    request = Request(source, FilterOptions(steps=steps), **more)
    return {"call": "filter_to_scratch", "request": request, "scratch": tmp_path / "out.ply"}


def long_work(samples: Path, tmp_path: Path) -> dict[str, Any]:
    return work(samples / "bunny.obj", tmp_path)


def test_a_mesh_that_takes_too_long_is_given_up(samples: Path, tmp_path: Path) -> None:
    with MeshLabProcess() as process:
        with pytest.raises(TimeLimitError, match="after 1 seconds"):
            process.run(long_work(samples, tmp_path), limits=JobLimits(seconds=1))
        assert not process.usable


def test_a_mesh_that_needs_too_much_memory_is_given_up(samples: Path, tmp_path: Path) -> None:
    with MeshLabProcess() as process, pytest.raises(MemoryLimitError, match="more than 60 MiB"):
        process.run(long_work(samples, tmp_path), limits=JobLimits(memory=60 * 2**20))


def test_the_peak_of_a_job_grows_with_its_mesh(cow: Path, samples: Path, tmp_path: Path) -> None:
    small, large = (work(one, tmp_path, 4) for one in (cow, samples / "bunny.obj"))
    with MeshLabProcess() as process:
        peaks = [process.run(job).peak_memory for job in (small, large)]
    assert 30e6 < peaks[0] < peaks[1] - 30e6


def test_a_process_that_died_before_its_job_is_reported(samples: Path, tmp_path: Path) -> None:
    with MeshLabProcess() as process:
        os.kill(process.pid, signal.SIGKILL)
        with pytest.raises(ProcessDiedError, match="SIGKILL"):
            process.run(long_work(samples, tmp_path))


def test_a_process_that_ends_in_the_middle_of_its_answer_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    child = tmp_path / "child"
    child.write_text("#!/bin/sh\nread job\necho a word on the end >&2\nprintf '{\"report\": {'\n")
    child.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(child))
    with MeshLabProcess() as process:
        with pytest.raises(ProcessDiedError, match="with status 0") as error:
            process.run({})
        assert "a word on the end" in str(error.value.__cause__)


def test_a_process_that_does_not_start_is_reported_with_the_cause(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "numpy.py").write_text("raise ImportError('numpy is damaged')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with (
        MeshLabProcess() as process,
        pytest.raises(ProcessStartError, match=r"before it was ready .*numpy is damaged"),
    ):
        process.run({})


NOISY = """
import os
os.write(1, b"3\\n[]\\n{ no JSON\\n" + 10000 * b"standard output \\xff\\n")
os.write(2, 10000 * b"standard error \\xff\\n" + 100000 * b"x")
"""


def test_output_of_libraries_is_no_answer_and_stops_nothing(
    cow: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sitecustomize.py").write_text(NOISY)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    job = {"call": "mesh_info", "request": Request(cow)}
    with MeshLabProcess() as process:
        assert process.run(job, limits=JobLimits(seconds=60)).report


def test_a_process_that_reads_nothing_is_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    child = tmp_path / "child"
    child.write_text("#!/bin/sh\nexec sleep 60\n")
    child.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(child))
    job = {"script": 10**6 * "long "}  # more than a pipe holds
    with MeshLabProcess() as process, pytest.raises(TimeLimitError):
        process.run(job, limits=JobLimits(seconds=0.5))


PARENT = """
import os, sys, threading, time
from meshlab_spectral.workers.process import MeshLabProcess, from_text
process = MeshLabProcess()
def tell(stage, fraction):
    if stage == "filtering":
        time.sleep(0.5)
        print(process.pid, flush=True)
        os.kill(os.getpid(), 9)
process.run(from_text(sys.argv[1]), tell)
"""


# One of MeshLab's own filters, which takes half a minute.
SCRIPT = (
    "<FilterScript>"
    '<filter name="Laplacian Smooth"><Param name="stepSmoothNum" type="RichInt" value="1000"/>'
    "</filter></FilterScript>"
)


@pytest.mark.parametrize("script", [None, SCRIPT], ids=["filter", "script"])
def test_a_killed_parent_leaves_no_process_at_work(
    script: str | None, samples: Path, tmp_path: Path
) -> None:
    job = as_text(work(samples / "bunny.obj", tmp_path, script=script))
    done = python("-c", PARENT, job)
    assert done.returncode == -signal.SIGKILL, done.stderr
    child = int(done.stdout.split()[0])
    wait_until(lambda: not (psutil.pid_exists(child) and alive([psutil.Process(child)])), 5)
