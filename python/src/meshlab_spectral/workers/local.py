"""Workers on this machine."""

from __future__ import annotations

import contextlib
import math
import os
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import psutil

from meshlab_spectral.errors import BatchError
from meshlab_spectral.files.whole_files import temporary_folder
from meshlab_spectral.workers.pool import JobT, ResultT, Workers
from meshlab_spectral.workers.process import JobLimits
from meshlab_spectral.workers.processes import Processes

# Fraction of the machine's memory that all workers share.
_SHARE_OF_MEMORY = 0.9
# While MeshLab filters one mesh, the files of another are copied and hashed.
_JOBS_PER_WORKER = 2
_GROUP = Path("/sys/fs/cgroup")  # the control group of a container, if any


@contextlib.contextmanager
def local_workers(
    do: Callable[[Processes, JobT], ResultT],
    count: int | None = None,
    memory_limit: int | None = None,
) -> Iterator[Workers[JobT, ResultT]]:
    """Yield workers that are processes of this machine.

    Each of the `count` workers, by default one per processor, does one job at a time, with its
    share of the threads. `memory_limit` is in bytes per worker; by default they share nine tenths
    of the machine's memory, and keep to the limit of the environment, if any.
    """
    count = count or processors()
    share = int(_SHARE_OF_MEMORY * machine_memory() / count)
    limits = JobLimits(memory_limit or share, replaces_environment=memory_limit is not None)
    with contextlib.ExitStack() as stack:
        try:
            folder = stack.enter_context(temporary_folder(Path(tempfile.gettempdir())))
        except OSError as error:
            raise BatchError(f"no temporary folder can be made ({error}): set TMPDIR") from error
        processes = Processes(count, limits, folder)
        stack.callback(processes.end)
        yield Workers(
            partial(do, processes),
            _JOBS_PER_WORKER * count,
            processes.end,
            limits.memory,
            lambda function: function(),
        )


def processors() -> int:
    """Return how many processors this process may use."""
    affinity = getattr(psutil.Process(), "cpu_affinity", None)  # missing on macOS
    count: int = len(affinity()) if affinity else os.cpu_count() or 1
    quota = _numbers("cpu.max") or _numbers("cpu/cpu.cfs_quota_us", "cpu/cpu.cfs_period_us")
    if len(quota) == 2 and quota[0] > 0:
        count = min(count, math.ceil(quota[0] / quota[1]))
    return count


def machine_memory() -> int:
    """Return how much memory this process and its children may use, in bytes."""
    total: int = psutil.virtual_memory().total
    return min([total, *_numbers("memory.max"), *_numbers("memory/memory.limit_in_bytes")])


def _numbers(*files: str) -> list[int]:
    """Return the numbers in files of the control group; none where it sets no limit."""
    try:
        return [int(word) for file in files for word in (_GROUP / file).read_text().split()]
    except (OSError, ValueError):  # ValueError: "max"
        return []
