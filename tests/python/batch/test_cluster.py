"""A batch on the workers of a Dask cluster that was started by hand."""

from __future__ import annotations

import contextlib
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from batches import REPORT, contents, make_meshes, records, start_batch, wait_until
from commands import command, messages_in
from meshlab_spectral import BatchError, filter_files
from meshlab_spectral.batch import engine


@pytest.fixture(scope="module")
def meshes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("meshes")
    make_meshes(folder, 6)
    return folder


@pytest.fixture(scope="module")
def expected(meshes: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    out = tmp_path_factory.mktemp("expected") / "out"
    assert command("batch", meshes, "--output", out, "--steps", 1).returncode == 0
    return contents(out)


@contextlib.contextmanager
def dask_cluster(folder: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """A scheduler and two workers, started by hand; the scheduler's address and process."""
    address_file = folder / "scheduler.json"
    dask = [sys.executable, "-m", "dask"]
    common = ["--no-dashboard", "--host", "127.0.0.1"]
    log = (folder / "log").open("w")
    started = [
        subprocess.Popen(
            [*dask, "scheduler", *common, "--port", "0", "--scheduler-file", str(address_file)],
            stdout=log,
            stderr=log,
        )
    ]
    try:
        wait_until(lambda: address_file.is_file() and address_file.stat().st_size > 0)
        for number in range(2):
            local = ["--local-directory", str(folder / str(number)), "--nthreads", "1"]
            file = ["--scheduler-file", str(address_file)]
            started.append(
                subprocess.Popen([*dask, "worker", *common, *file, *local], stdout=log, stderr=log)
            )
        wait_until(lambda: (folder / "log").read_text().count("Registered to:") >= 2)
        yield json.loads(address_file.read_text())["address"], started[0]
    finally:
        for process in reversed(started):
            process.kill()  # a worker ends with its nanny
            process.wait()
        log.close()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with dask_cluster(tmp_path_factory.mktemp("cluster")) as (address, _):
        yield address


def test_an_existing_cluster_gives_the_same_outputs(
    cluster: str, meshes: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    done = command("batch", meshes, "--output", out, "--steps", 1, "--scheduler", cluster)
    assert done.returncode == 0, done.stderr
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
    monkeypatch.setattr(engine, "_SECONDS_TO_CONNECT", 0.5)
    with pytest.raises(BatchError, match="no Dask scheduler"):
        list(filter_files(meshes, tmp_path / "out", scheduler="tcp://127.0.0.1:1"))


def test_a_cluster_that_disappears_midway_is_reported_in_one_line(tmp_path: Path) -> None:
    folder, out = tmp_path / "in", tmp_path / "out"
    make_meshes(folder, 12, rings=32)
    with dask_cluster(tmp_path) as (address, scheduler):
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
