"""Memory of a run, and of many."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from functools import partial

import bench_defaults
import bench_memory

from promises.record import Found, Promise, at_most, largest, promise, shared

DRAGON = "data/dragon_40k.ply"
RUNS = 40


def promises() -> Iterator[Promise]:
    yield from one_run()
    yield from many_runs()


def one_run() -> Iterator[Promise]:
    """A run keeps little: ten conformal steps take 55 MB, Python and the mesh 87.

    The default run is to take no more than that. 60: memory is counted by pages and arenas.
    """
    for name, setting in (("default run", "default"), ("conformal K = 10", "conformal-15")):
        yield promise(
            f"MB above the loaded mesh, {name}: dragon_40k", at_most(60), partial(of_run, setting)
        )


def many_runs() -> Iterator[Promise]:
    """A process may run filters for ever (tests/benchmarks/README.md, Memory).

    5 MB: one mesh of these kept in each run would be 30.
    """
    yield promise(
        f"MB more after {RUNS} runs of a filter than after {bench_memory.FEW_RUNS}",
        at_most(5),
        growth,
    )


def of_run(setting: str) -> float:
    row = bench_defaults.measured(str(shared(DRAGON)), setting, smoothings=())
    return float(row["megabytes"])


def growth() -> Found:
    """Ask in a process of its own, where nothing else has been allocated."""
    code = f"from bench_memory import print_runs; print_runs({RUNS})"
    command = [sys.executable, "-c", code]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = [line.split() for line in out.splitlines()[1:]]
    return largest((name, float(after) - float(few)) for name, few, after in rows)
