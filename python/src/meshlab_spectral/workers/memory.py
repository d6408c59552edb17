"""How many processors and how much memory there are, and how the processes of a run share them."""

from __future__ import annotations

import math
import os
from pathlib import Path

import psutil

from meshlab_spectral.plugin.limits import given_memory_limit

# Peak memory, measured (tests/benchmarks/bench_tiles.py): of a tile, for each vertex, at most, and
# of a process without a mesh, with what it has mapped.
TILE_BYTES, PROCESS_BYTES = 1100, 150 * 2**20
_GROUP = Path("/sys/fs/cgroup")  # the control group of a container, if any


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


def available_memory() -> int:
    """Return how much memory this process and its children may still take, in bytes."""
    free: int = min(machine_memory(), psutil.virtual_memory().available)
    return min(free, given_memory_limit() or free)


def workers_for_tiles() -> tuple[int, int]:
    """Return the number of child processes, and the memory of each, in bytes."""
    available = available_memory()
    count = _workers_within(available)
    return count, (available - PROCESS_BYTES) // count


def limit_for(each: int) -> int:
    """Return the least `available_memory` that gives every child process so many bytes."""
    limits = ((count, PROCESS_BYTES + count * each) for count in range(1, processors() + 1))
    return next(limit for count, limit in limits if _workers_within(limit) <= count)


def _workers_within(available: int) -> int:
    count = processors()
    while count > 1 and (available - PROCESS_BYTES) // count <= 4 * PROCESS_BYTES:
        count -= 1
    return count
