"""Dask clusters for tests: real ones, with a scheduler and workers on this machine."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import psutil
from batches import alive, wait_until

CHILD = "meshlab_spectral.child"


@contextlib.contextmanager
def dask_cluster(
    folder: Path, workers: int = 2, before: Sequence[str] = ()
) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler and workers, started by hand; the scheduler's address, and all processes.

    The command of a worker follows the words in `before`.
    """
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
        for number in range(workers):
            local = ["--local-directory", str(folder / str(number)), "--nthreads", "1"]
            file = ["--scheduler-file", str(address_file)]
            started.append(
                subprocess.Popen(
                    [*before, *dask, "worker", *common, *file, *local], stdout=log, stderr=log
                )
            )
        wait_until(lambda: (folder / "log").read_text().count("Registered to:") >= workers)
        yield json.loads(address_file.read_text())["address"], started
    finally:
        for process in reversed(started):
            process.kill()  # a worker ends with its nanny
            process.wait()
        log.close()


def meshlab_processes(workers: list[psutil.Process]) -> list[psutil.Process]:
    children = [child for worker in workers for child in worker.children(recursive=True)]
    return [child for child in alive(children) if CHILD in child.cmdline()]
