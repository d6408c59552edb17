"""The truncated basis against other programs: seconds, accuracy and memory, as a table.

usage: bench_basis.py [--help] [--mesh MESH] [-k K] [--programs NAME,NAME...] ...

Every program computes the k lowest eigenpairs of W phi = lambda D phi of the same mesh, with the
cotangent Laplacian, free (Neumann) boundary and lumped masses; W and D are given (LaPy builds its
own, equal up to round-off). How the comparison is made fair, and what is measured:

- Relative residuals of at most 1e-8 are requested. They are measured here, in the same way for
  every program (basis_problem.py), as are the errors of eigenvalues and the missing pairs.
- Times begin with the factorization and end with the eigenvectors; reading the mesh, building W and
  D, and importing are excluded, except where a row says "from arrays to arrays".
- Every program has the same cores (--cores), for its own threads and for those of BLAS (unless
  --blas-threads says less), and a new process for every run. The programs take turns, so that a
  change of the machine's speed affects all of them. Ratios compare the best times.
- Memory is the increase of the process's peak over its memory at the start; n k doubles of it are
  the basis itself.
- The settings of the other programs are explained in basis_solvers.py; Spectra uses our own
  Cholesky factorization with ncv = 2k, as its documentation recommends (bench_basis.cpp).
- geogram is missing: Debian 12 has no package, and the one on PyPI is compiled without the loading
  of ARPACK, which its manifold harmonics need.

A program that is not installed is skipped, with the reason.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field

from basis_problem import Check, Pairs, check, read_pairs, read_problem
from rich.box import MARKDOWN
from rich.console import Console
from rich.table import Table

HERE = pathlib.Path(__file__).parent
REPOSITORY = HERE.parents[1]
DRAGON = REPOSITORY.parent / "shared" / "data" / "dragon_40k.ply"
BINARY = REPOSITORY / "build" / "tests" / "benchmarks" / "bench_basis"


@dataclass(frozen=True)
class Program:
    """One row: the program, the number of its cores (None: all) and of its pairs."""

    title: str
    task: str
    compiled: bool = False
    cores: int | None = None
    larger: bool = False


PACKAGES = ("numpy", "scipy", "scikit-sparse", "lapy", "cholespy")
"""Packages that may affect the results; their versions are printed."""

OURS = "ours"
PROGRAMS = {
    OURS: Program("ours", "slices", compiled=True),
    "ours-one-core": Program("ours, one core", "slices", compiled=True, cores=1),
    "ours-larger": Program("ours", "slices", compiled=True, larger=True),
    "ours-python": Program("ours, from arrays to arrays", "meshlab-spectral"),
    "spectra": Program("Spectra, one run, our Cholesky", "spectra", compiled=True),
    "scipy-superlu": Program("SciPy eigsh, SuperLU as it is", "scipy-superlu"),
    "scipy-superlu-symmetric": Program("SciPy eigsh, SuperLU symmetric", "scipy-superlu-symmetric"),
    "scipy-cholmod": Program("SciPy eigsh, CHOLMOD", "scipy-cholmod"),
    "lapy": Program("LaPy", "lapy-superlu"),
    "lapy-cholmod": Program("LaPy, CHOLMOD", "lapy-cholmod"),
}


@dataclass
class Row:
    """The results of the runs of a program."""

    k: int
    seconds: list[float] = field(default_factory=list)
    megabytes: list[float] = field(default_factory=list)
    check: Check | None = None


class NotRunError(Exception):
    """A program is not installed, or failed; the message says why."""


class Bench:
    """One mesh in a folder of its own, and the programs that are run on it."""

    def __init__(self, options: argparse.Namespace, folder: pathlib.Path):
        self.options = options
        self.folder = folder
        sizes = self.started([options.binary, "matrices", options.mesh, folder], options.cores)
        self.components = sizes["components"]
        self.problem = read_problem(folder)

    def run(self, program: Program, k: int) -> tuple[dict[str, float], Pairs]:
        """Run a program once."""
        what: list[object] = (
            [self.options.binary, program.task, self.options.mesh]
            if program.compiled
            else [sys.executable, HERE / "basis_solvers.py", program.task]
        )
        took = self.started([*what, self.folder, k], program.cores or self.options.cores)
        if "skipped" in took:
            raise NotRunError(f"skipped: {took['skipped']}")
        return took, read_pairs(self.folder, self.problem.D)

    def started(self, command: list[object], cores: int) -> dict[str, float]:
        """Run a command on the first `cores` cores; return the JSON of its last line."""
        own = sorted(os.sched_getaffinity(0))[:cores]
        pinned = ["taskset", "--cpu-list", ",".join(map(str, own)), *map(str, command)]
        blas = str(self.options.blas_threads or len(own))
        threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"), blas)
        done = subprocess.run(pinned, env=os.environ | threads, capture_output=True, text=True)
        if done.returncode != 0:
            lines = done.stderr.strip().splitlines() or ["no message"]
            raise NotRunError(f"failed with exit code {done.returncode}: {lines[-1]}")
        return dict(json.loads(done.stdout.splitlines()[-1]))


def measured(bench: Bench, names: list[str]) -> tuple[dict[str, Row], dict[str, str]]:
    """Run the programs in turns; return the rows, and why a program has none."""
    options = bench.options
    rows: dict[str, Row] = {}
    reasons: dict[str, str] = {}
    reference: Pairs | None = None
    for turn in range(options.repetitions):
        for name in names:
            if name in reasons:
                continue
            program = PROGRAMS[name]
            print(f"turn {turn + 1} of {options.repetitions}: {name}", file=sys.stderr, flush=True)
            row = rows.get(name) or Row(options.larger_k if program.larger else options.k)
            try:
                took, pairs = bench.run(program, row.k)
            except NotRunError as error:
                reasons[name] = str(error)
                continue
            rows[name] = row
            row.seconds.append(took["seconds"])
            row.megabytes.append(took["megabytes"])
            if name == OURS and reference is None:
                reference = pairs
            if row.check is None and reference is not None:
                row.check = check(bench.problem, bench.components, row.k, pairs, reference)
    return {name: row for name, row in rows.items() if name not in reasons}, reasons


def table_of(rows: dict[str, Row]) -> Table:
    """Format the rows as a Markdown table, for the README."""
    table = Table(box=MARKDOWN)
    for title in ("program", "k", "seconds", "median", "ratio", "residual", "eigenvalues"):
        table.add_column(title, justify="left" if title == "program" else "right", no_wrap=True)
    table.add_column("missing", justify="right", no_wrap=True)
    table.add_column("MB", justify="right", no_wrap=True)
    ours = min(rows[OURS].seconds)
    for name, row in rows.items():
        assert row.check is not None
        table.add_row(
            PROGRAMS[name].title,
            str(row.k),
            f"{min(row.seconds):.2f}",
            f"{statistics.median(row.seconds):.2f}",
            f"{min(row.seconds) / ours:.1f}",
            f"{row.check.residual:.0e}",
            f"{row.check.difference:.0e}",
            str(row.check.missing),
            f"{statistics.median(row.megabytes):.0f}",
        )
    return table


def versions() -> str:
    """List the installed packages and their versions."""
    present = {package.name.lower() for package in importlib.metadata.distributions()}
    return ", ".join(
        f"{name} {importlib.metadata.version(name)}"
        for name in PACKAGES
        if name in present or name.replace("-", "_") in present
    )


def chosen(text: str) -> list[str]:
    """Parse a list of programs."""
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name not in PROGRAMS:
            raise argparse.ArgumentTypeError(f"no program {name}; there are {', '.join(PROGRAMS)}")
    return names


def options_of(arguments: list[str]) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--mesh", type=pathlib.Path, default=DRAGON, help="binary PLY of x, y, z and triangles"
    )
    parser.add_argument("-k", type=int, default=300, help="pairs (300)")
    parser.add_argument("--larger-k", type=int, default=1000, help="pairs of ours-larger (1000)")
    parser.add_argument("--repetitions", type=int, default=3, help="runs of each program (3)")
    parser.add_argument("--cores", type=int, default=2, help="cores for everyone (2)")
    parser.add_argument("--blas-threads", type=int, help="threads of BLAS (as many as cores)")
    parser.add_argument(
        "--programs",
        type=chosen,
        default=list(PROGRAMS),
        help=f"some of {', '.join(PROGRAMS)} (all); {OURS} always runs",
    )
    parser.add_argument("--binary", type=pathlib.Path, default=BINARY, help="the C++ part")
    options = parser.parse_args(arguments)
    for file in (options.mesh, options.binary):
        if not file.is_file():
            parser.error(f"no {file}")
    if min(options.k, options.larger_k, options.repetitions, options.cores) < 1:
        parser.error("sizes and numbers must be positive")
    return options


def main() -> int:
    """Measure and print; 1 when our own basis failed."""
    options = options_of(sys.argv[1:])
    names = [OURS, *(name for name in options.programs if name != OURS)]
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        try:
            bench = Bench(options, pathlib.Path(folder))
        except NotRunError as error:
            sys.exit(f"{options.mesh}: {error}")
        rows, reasons = measured(bench, names)
    vertices = len(bench.problem.D)
    print(
        f"{options.mesh.name}: {vertices} vertices, k = {options.k}, {options.cores} cores, "
        f"best and median of {options.repetitions} runs; the basis itself is "
        f"{vertices * options.k * 8 / 2**20:.0f} MB\n{versions()}; load before: {load:.1f}\n"
    )
    if OURS in rows:
        Console(width=140).print(table_of(rows))
    for name, reason in reasons.items():
        print(f"{name} {reason}")
    return 0 if OURS in rows else 1


if __name__ == "__main__":
    sys.exit(main())
