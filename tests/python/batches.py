"""What the tests of whole batches need: meshes, running batches, comparing their outputs."""

from __future__ import annotations

import json
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from commands import COMMAND
from helpers import mesh_set_of
from shapes import grid, quads

REPORT = "batch_report.jsonl"


def make_meshes(folder: Path, count: int, seed: int = 0, rings: int = 12) -> list[Path]:
    """Write noisy tori as .ply files, no two alike."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(seed)
    k = np.arange(rings)
    i, j = (index.ravel() for index in np.meshgrid(k, k))
    F = quads(grid(rings, rings, 0, 1).T)
    u, v = (index * 2 * np.pi / rings for index in (i, j))
    radius = 1 + 0.7 * np.cos(v)  # triangles that are not needles
    torus = np.column_stack([radius * np.cos(u), radius * np.sin(u), 0.7 * np.sin(v)])
    paths = []
    for number in range(count):
        V = torus + 0.02 * rng.standard_normal(torus.shape)
        mesh_set = mesh_set_of(V, F.astype(np.int32))
        paths.append(folder / f"torus_{number:03}.ply")
        mesh_set.save_current_mesh(str(paths[-1]))
    return paths


def records(report: Path, kind: str = "file") -> list[dict[str, Any]]:
    """Return the lines of a report, without a line that is still being written."""
    if not report.is_file():
        return []
    lines = report.read_text(encoding="utf-8").splitlines(keepends=True)
    whole = [json.loads(line) for line in lines if line.endswith("\n")]
    return [record for record in whole if record["kind"] == kind]


def contents(folder: Path) -> dict[str, bytes]:
    """Return every file below a folder, including hidden ones but not the report."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != REPORT
    }


def start_batch(*arguments: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, "batch", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,  # a terminal of its own: Ctrl-C goes to all of its processes
        # A shell's background jobs, and all that they start, ignore Ctrl-C; this one must not.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def below(process: subprocess.Popen[str], word: str = "") -> list[psutil.Process]:
    """Return the processes started by a command whose command line contains a word."""
    found = []
    for child in psutil.Process(process.pid).children(recursive=True):
        try:
            if word in " ".join(child.cmdline()):
                found.append(child)
        except psutil.NoSuchProcess:
            continue
    return found


def alive(processes: list[psutil.Process]) -> list[psutil.Process]:
    return [
        process
        for process in processes
        if process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    ]


def wait_until(reached: Callable[[], bool], seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not reached():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)
