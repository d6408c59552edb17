"""How much memory there is, and how the processes of a run share it."""

from __future__ import annotations

import psutil

from meshlab_spectral.batch.local import machine_memory, processors
from meshlab_spectral.plugin.limits import given_memory_limit

# Peak memory, measured (tests/benchmarks/bench_tiles.py): of a tile, for each vertex, at most, and
# of a process without a mesh, with what it has mapped.
TILE_BYTES, PROCESS_BYTES = 1100, 150 * 2**20


def available_memory() -> int:
    """Return how much memory this process and its children may still take, in bytes."""
    free: int = min(machine_memory(), psutil.virtual_memory().available)
    return min(free, given_memory_limit() or free)


def workers() -> tuple[int, int]:
    """Return the number of child processes, and the memory of each, in bytes."""
    count = processors()
    while True:
        each = (available_memory() - PROCESS_BYTES) // count
        if count == 1 or each > 4 * PROCESS_BYTES:
            return count, each
        count -= 1
