"""Batches that are killed or interrupted, or whose workers are killed: nothing is lost."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from batches import REPORT, alive, below, contents, make_meshes, records, start_batch, wait_until
from commands import messages_in, succeeded

MESHES = 12
CHILD = "meshlab_spectral.child"
# Long enough that the batch is still working when a busy machine delivers the signal late.
OPTIONS = ["--steps", 600, "--workers", 2]


@pytest.fixture(scope="module")
def meshes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("meshes")
    make_meshes(folder, MESHES, rings=32)
    return folder


@pytest.fixture(scope="module")
def undisturbed(meshes: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    out = tmp_path_factory.mktemp("undisturbed") / "out"
    succeeded("batch", meshes, "--output", out, *OPTIONS)
    return contents(out)


@pytest.fixture
def running(meshes: Path, tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """A batch, some files of which are done and others at work."""
    process = start_batch(meshes, "--output", tmp_path / "out", *OPTIONS)
    try:
        wait_until(lambda: len(records(tmp_path / "out" / REPORT)) >= 2)
        yield process
    finally:
        process.kill()
        process.communicate()


def assert_only_whole_files(out: Path, undisturbed: dict[str, bytes]) -> None:
    """What is there is as it should be, and so is what the report names."""
    assert {record["name"] for record in records(out / REPORT)} <= contents(out).keys()
    assert contents(out).items() <= undisturbed.items()


def assert_resumes(meshes: Path, out: Path, undisturbed: dict[str, bytes]) -> None:
    done_before = len(records(out / REPORT))
    assert 2 <= done_before < MESHES
    done = succeeded("batch", meshes, "--output", out, *OPTIONS, "--resume")
    assert f"{done_before} already done" in done.stdout
    assert contents(out) == undisturbed
    assert not list(out.rglob("*.partial"))


def test_workers_ignore_an_interruption_and_a_killed_one_is_replaced(
    running: subprocess.Popen[str], undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    processes = below(running, CHILD)
    for process in processes:  # they leave it to the command
        process.send_signal(signal.SIGINT)
    time.sleep(0.5)
    assert len(alive(processes)) == 2
    processes[0].kill()
    stdout, stderr = running.communicate(timeout=120)
    assert running.returncode == 0, stderr
    assert messages_in(stderr) == ""
    assert f"{MESHES} filtered, 0 failed" in stdout
    out = tmp_path / "out"
    assert contents(out) == undisturbed
    assert not list(out.rglob("*.partial"))


@pytest.mark.parametrize("how", ["Ctrl-C", "SIGINT", "SIGTERM", "SIGTERM to all"])
def test_an_interrupted_batch_ends_soon_with_130_and_resumes(
    how: str,
    running: subprocess.Popen[str],
    meshes: Path,
    undisturbed: dict[str, bytes],
    tmp_path: Path,
) -> None:
    processes = below(running)
    assert len(processes) == 2
    number = signal.SIGTERM if "SIGTERM" in how else signal.SIGINT
    if how in ("Ctrl-C", "SIGTERM to all"):
        os.killpg(running.pid, number)
    else:
        running.send_signal(number)
    stdout, stderr = running.communicate(timeout=20)
    assert running.returncode == 130
    assert stdout == ""
    interrupted = "Interrupted: finished files are in the report; continue with --resume.\n"
    assert messages_in(stderr) == interrupted
    assert not alive(processes)
    assert not list((tmp_path / "out").rglob("*.partial"))
    outcomes = {record["outcome"] for record in records(tmp_path / "out" / REPORT)}
    assert outcomes == {"filtered"}
    assert_only_whole_files(tmp_path / "out", undisturbed)
    if how == "Ctrl-C":  # the others leave the same
        assert_resumes(meshes, tmp_path / "out", undisturbed)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_copies_of_files_at_urls_go_with_the_interrupted_batch_or_the_next_one(
    number: signal.Signals, meshes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    # A chain of file systems is a URL to fsspec, not a path.
    urls = [f"filecache::{path.as_uri()}" for path in sorted(meshes.iterdir())[:4]]
    batch = [*urls, "--output", tmp_path / "out", *OPTIONS]
    process = start_batch(*batch)
    try:
        wait_until(lambda: bool(list(temporary.rglob("*.ply"))))
        process.send_signal(number)
        process.communicate(timeout=20)
    finally:
        process.kill()
        process.communicate()
    if number == signal.SIGKILL:
        assert list(temporary.rglob("*.ply"))
        succeeded("batch", *batch, "--resume")
    else:
        assert process.returncode == 130
        assert not list(temporary.rglob("*meshlab-spectral*"))
    assert not list(temporary.rglob("*.ply"))


def test_a_killed_batch_leaves_no_process_and_resumes(
    running: subprocess.Popen[str], meshes: Path, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    processes = below(running)
    assert len(processes) == 2
    running.kill()
    wait_until(lambda: not alive(processes), seconds=10)
    out = tmp_path / "out"
    for name, content in contents(out).items():
        if ".partial/" not in name:
            assert content == undisturbed[name]
    assert_resumes(meshes, out, undisturbed)
