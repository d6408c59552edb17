"""A batch on the workers of a Dask cluster that was started by hand."""

from __future__ import annotations

import os
import re
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from unittest.mock import patch

import psutil
import pytest
from batches import REPORT, contents, make_meshes, records, start_batch, wait_until
from commands import messages_in, succeeded
from dask_clusters import dask_cluster, meshlab_processes
from distributed import get_worker
from meshlab_spectral import BatchError, filter_files
from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.workers import cluster as cluster_module
from meshlab_spectral.workers.processes import Processes

MESHES = 8  # more than the two workers have done when a signal arrives
_Doing = Callable[[Processes, Job], FileResult]


@pytest.fixture(scope="module")
def meshes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("meshes")
    make_meshes(folder, 6)
    return folder


@pytest.fixture(scope="module")
def expected(meshes: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    out = tmp_path_factory.mktemp("expected") / "out"
    succeeded("batch", meshes, "--output", out, "--steps", 1)
    return contents(out)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with dask_cluster(tmp_path_factory.mktemp("cluster")) as (address, processes):
        workers = [psutil.Process(process.pid) for process in processes[1:]]
        yield address
        wait_until(lambda: not meshlab_processes(workers))  # whatever has happened to batches


def test_an_existing_cluster_gives_the_same_outputs(
    cluster: str, meshes: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    succeeded("batch", meshes, "--output", out, "--steps", 1, "--scheduler", cluster)
    assert contents(out) == expected
    assert len(records(out / REPORT)) == 6


def test_a_cluster_takes_urls_of_shared_files(
    cluster: str, meshes: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    # A chain of file systems is a URL to fsspec, not a path: files are copied to the workers.
    source = f"filecache::{meshes.as_uri()}"
    places = [f"{source}/{name}" for name in sorted(expected)]
    results = list(
        filter_files(places, out.as_uri(), scheduler=cluster, report=tmp_path / "r", steps=1)
    )
    assert [result.outcome for result in results] == ["filtered"] * 6
    assert contents(out) == expected


def test_a_cluster_that_is_not_there_is_reported(
    meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "_SECONDS_TO_CONNECT", 0.5)
    with pytest.raises(BatchError, match="no Dask scheduler"):
        list(filter_files(meshes, tmp_path / "out", scheduler="tcp://127.0.0.1:1"))


def test_a_cluster_without_workers_is_reported(
    meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "_SECONDS_TO_CONNECT", 1)
    with (
        dask_cluster(tmp_path, workers=0) as (address, _),
        pytest.raises(BatchError, match="has no workers: start some"),
    ):
        list(filter_files(meshes, tmp_path / "out", scheduler=address))


def test_a_cluster_with_other_versions_is_refused(
    cluster: str, meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "versions", lambda: {"core": str(os.getpid())})
    with pytest.raises(BatchError, match="has different software from this machine: core"):
        list(filter_files(meshes, tmp_path / "out", scheduler=cluster))


def test_a_file_whose_workers_die_again_and_again_fails_alone(
    cluster: str, meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inputs, out = sorted(meshes.iterdir())[:3], tmp_path / "out"
    deadly = inputs[0].name

    def run_or_die(plugin: str, do: _Doing, job: Job) -> FileResult:
        if job.name != deadly:
            return do(get_worker().plugins[plugin].processes, job)
        while (out / REPORT).read_text().count('"kind": "file"') < 2:  # of the others
            time.sleep(0.02)
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError("unreachable")

    monkeypatch.setattr(cluster_module, "_run", run_or_die)
    results = {r.name: r for r in filter_files(inputs, out, scheduler=cluster, steps=1)}
    failed = results.pop(deadly)
    assert failed.outcome == "failed"
    assert "ended from outside" in (failed.reason or "")
    assert failed.attempts > 1
    assert [result.outcome for result in results.values()] == ["filtered"] * 2


def test_files_queued_at_a_worker_that_dies_are_tried_again(
    cluster: str,
    meshes: Path,
    expected: dict[str, bytes],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Dask counts the death against all that the worker had."""
    inputs, out = sorted(meshes.iterdir()), tmp_path / "out"
    deadly = inputs[0].name

    def run_or_die(plugin: str, do: _Doing, job: Job) -> FileResult:
        if job.name == deadly:
            os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(0.2)  # so that others are queued
        return do(get_worker().plugins[plugin].processes, job)

    monkeypatch.setattr(cluster_module, "_run", run_or_die)
    results = {r.name: r for r in filter_files(inputs, out, scheduler=cluster, steps=1)}
    failed = results.pop(deadly)
    assert failed.outcome == "failed"
    assert "and one that did nothing else" in (failed.reason or "")
    assert {one.outcome for one in results.values()} == {"filtered"}
    assert contents(out) == {name: mesh for name, mesh in expected.items() if name != deadly}


def test_an_interrupted_batch_ends_its_processes_on_the_workers_and_resumes(tmp_path: Path) -> None:
    folder, out = tmp_path / "in", tmp_path / "out"
    make_meshes(folder, MESHES, rings=32)
    with dask_cluster(tmp_path) as (address, (_, *started)):
        workers = [psutil.Process(process.pid) for process in started]
        options = ["--output", out, "--steps", 600, "--scheduler", address]
        batch = start_batch(folder, *options)
        try:
            wait_until(lambda: bool(records(out / REPORT)))
            assert meshlab_processes(workers)
            batch.send_signal(signal.SIGINT)
            _, stderr = batch.communicate(timeout=30)
        finally:
            batch.kill()
            batch.communicate()
        assert batch.returncode == 130
        assert messages_in(stderr).startswith("Interrupted: finished files are in the report")
        wait_until(lambda: not meshlab_processes(workers))
        done = records(out / REPORT)
        assert {record["outcome"] for record in done} == {"filtered"}
        resumed = succeeded("batch", folder, *options, "--resume")
        rest = MESHES - len(done)
        assert f"{rest} filtered, 0 failed, {len(done)} already done" in resumed.stdout
        assert not list(out.rglob("*.partial"))


def test_a_killed_batch_ends_its_work_on_the_workers(tmp_path: Path) -> None:
    folder, out = tmp_path / "in", tmp_path / "out"
    make_meshes(folder, MESHES, rings=32)
    with dask_cluster(tmp_path) as (address, (_, *started)):
        workers = [psutil.Process(process.pid) for process in started]
        batch = start_batch(folder, "--output", out, "--steps", 600, "--scheduler", address)
        try:
            wait_until(lambda: bool(records(out / REPORT)))
        finally:
            batch.kill()
            batch.communicate()
        wait_until(lambda: not any(p.cpu_percent(0.5) > 0 for p in meshlab_processes(workers)))
        assert len(contents(out)) < MESHES


def test_a_meshlab_process_killed_on_a_worker_is_replaced(
    meshes: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    with dask_cluster(tmp_path) as (address, (_, *started)):
        workers = [psutil.Process(process.pid) for process in started]
        results = filter_files(meshes, tmp_path / "out", scheduler=address, steps=1)
        next(results)
        for process in meshlab_processes(workers):
            process.kill()
        assert [result.outcome for result in results] == ["filtered"] * 5
    assert contents(tmp_path / "out") == expected


def test_a_cluster_whose_processes_do_not_start_is_reported(
    cluster: str, meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run_without_python(plugin: str, do: _Doing, job: Job) -> FileResult:
        with patch.object(sys, "executable", "/bin/false"):
            return do(get_worker().plugins[plugin].processes, job)

    monkeypatch.setattr(cluster_module, "_run", run_without_python)
    with pytest.raises(BatchError, match="with status 1 before it was ready"):
        list(filter_files(meshes, tmp_path / "out", scheduler=cluster, steps=1))


def test_a_cluster_that_disappears_midway_is_reported_in_one_line(tmp_path: Path) -> None:
    folder, out = tmp_path / "in", tmp_path / "out"
    make_meshes(folder, MESHES, rings=32)
    with dask_cluster(tmp_path) as (address, (scheduler, *_)):
        batch = start_batch(folder, "--output", out, "--steps", 60, "--scheduler", address)
        try:
            wait_until(lambda: bool(records(out / REPORT)))
            scheduler.kill()
            stdout, stderr = batch.communicate(timeout=120)
        finally:
            batch.kill()
            batch.communicate()
    assert batch.returncode == 1
    assert stdout == ""
    assert re.fullmatch("Error: the Dask cluster is gone.*--resume\n", messages_in(stderr))
