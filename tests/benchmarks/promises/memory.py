"""Memory of a run, and of many."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator

import bench_defaults
import bench_memory
import bench_pymeshlab

from promises.record import Found, Promise, at_most, largest, promise, shared

DRAGON = "data/dragon_40k.ply"
CONFORMAL = "gaussian low-pass 15 %, conformal K = 10"
RUNS = 40


def promises() -> Iterator[Promise]:
    yield from one_run()
    yield from many_runs()


def one_run() -> Iterator[Promise]:
    """Ten conformal steps peak at 142 MB, 87 MB of them Python and mesh (benchmarks/README.md).

    The default run is to take no more than that. 60: memory is counted by pages and arenas.
    """
    yield promise("MB above the loaded mesh, default run: dragon_40k", at_most(60), of_default)
    yield promise("MB above the loaded mesh, conformal K = 10: dragon_40k", at_most(60), of_ten)


def many_runs() -> Iterator[Promise]:
    """A process may run filters for ever (tests/benchmarks/README.md, Memory).

    5 MB: one mesh of these kept in each run would be 30.
    """
    yield promise(
        f"MB more after {RUNS} runs of a filter than after {bench_memory.FEW_RUNS}",
        at_most(5),
        growth,
    )


def of_default() -> float:
    row = bench_defaults.measured(str(shared(DRAGON)), smoothings=())
    return float(row["megabytes"])


def of_ten() -> float:
    mesh = str(shared(DRAGON))
    rows = [bench_pymeshlab.measured(mesh, case)["megabytes"] for case in (CONFORMAL, "load only")]
    return rows[0] - rows[1]


def growth() -> Found:
    """Ask in a process of its own, where nothing else has been allocated."""
    code = f"from bench_memory import print_runs; print_runs({RUNS})"
    command = [sys.executable, "-c", code]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = [line.split() for line in out.splitlines()[1:]]
    return largest((name, float(after) - float(few)) for name, few, after in rows)
