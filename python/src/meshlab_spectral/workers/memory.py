"""How much memory there is, and how the processes of a run share it."""

from __future__ import annotations

import psutil

from meshlab_spectral.plugin.limits import given_memory_limit
from meshlab_spectral.workers.local import machine_memory, processors

# Peak memory, measured (tests/benchmarks/bench_tiles.py): of a tile, for each vertex, at most, and
# of a process without a mesh, with what it has mapped.
TILE_BYTES, PROCESS_BYTES = 1100, 150 * 2**20


def available_memory() -> int:
    """Return how much memory this process and its children may still take, in bytes."""
    free: int = min(machine_memory(), psutil.virtual_memory().available)
    return min(free, given_memory_limit() or free)


def workers() -> tuple[int, int]:
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
