"""Shape-DNA, heat and wave kernel signatures against LaPy and pyFM, as a table.

usage: bench_signatures.py [--repetitions N] [-k K] [MESH ...]

A row is a result that another program computes, too: the seconds of both, the least of N (3)
alternating runs in one process, and the largest relative difference of an entry. All use the
cotangent Laplacian with lumped masses and a free boundary. "From arrays" starts from coordinates
and triangles and includes the K (100) harmonics, for which LaPy uses CHOLMOD; "of a basis" starts
from our harmonics and times the formula alone.

Times and energies are ours: LaPy leaves times to its user, and pyFM's sigma is 7 / COUNT of the
whole range of energies, before the margins are removed.

MESH defaults to meshes of ../shared/data next to the repository; absent ones are skipped.
"""

from __future__ import annotations

import argparse
import pathlib
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import lapy
import lapy.heat
import lapy.shapedna
import numpy as np
import pyFM.signatures
from meshlab_spectral import Harmonics, load, manifold_harmonics, shape_dna
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.filters.harmonics import heat_times, wave_energies
from numpy.typing import NDArray
from rich.box import MARKDOWN
from rich.console import Console
from rich.table import Table

DATA = pathlib.Path(__file__).resolve().parents[3] / "shared" / "data"
MESHES = [DATA / name for name in ("rocker-arm.obj", "dragon_40k.ply")]

EIGENVALUES = 50
TIMES, ENERGIES = 16, 100

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """A result, by us and by another program."""

    name: str
    other: str
    ours: Callable[[], Array]
    theirs: Callable[[], Array]


def cases(V: Array, F: NDArray[Any], k: int) -> list[Case]:
    """List what is compared on a mesh."""
    basis = manifold_harmonics(V, F, k, "cotangent")
    t = heat_times(basis.eigenvalues, TIMES)
    e, sigma = wave_energies(basis.eigenvalues, ENERGIES)
    vertices = np.arange(len(V))

    def lapy_pairs() -> tuple[Array, Array]:
        lam, Phi = lapy.Solver(lapy.TriaMesh(V, F), lump=True, use_cholmod=True).eigs(k, rng=1)
        return lam, Phi

    def lapy_dna() -> Array:
        mesh = lapy.TriaMesh(V, F)
        found = lapy.shapedna.compute_shapedna(mesh, EIGENVALUES, lump=True, use_cholmod=True)
        return np.asarray(lapy.shapedna.normalize_ev(mesh, found["Eigenvalues"]))

    def lapy_heat(lam: Array, Phi: Array) -> Array:
        # As a row and a column: their product has every eigenvalue times every time.
        return np.asarray(lapy.heat.diagonal(t[None], vertices, Phi, lam[:, None], len(lam)))

    def our_basis() -> Harmonics:
        return manifold_harmonics(V, F, k, "cotangent")

    def pyfm_wave(lam: Array, Phi: Array) -> Array:
        return np.asarray(pyFM.signatures.WKS(lam, Phi, e, sigma, scaled=True))

    lam, Phi = basis.eigenvalues, basis.harmonics
    return [
        Case(
            f"Shape-DNA, {EIGENVALUES}, from arrays",
            "LaPy",
            lambda: shape_dna(V, F, EIGENVALUES, laplacian="cotangent"),
            lapy_dna,
        ),
        Case(
            f"HKS, {TIMES} times, from arrays",
            "LaPy",
            lambda: our_basis().heat_kernel_signature(),
            lambda: lapy_heat(*lapy_pairs()),
        ),
        Case(
            f"WKS, {ENERGIES} energies, from arrays",
            "LaPy, pyFM",
            lambda: our_basis().wave_kernel_signature(ENERGIES),
            lambda: pyfm_wave(*lapy_pairs()),
        ),
        Case(
            f"HKS, {TIMES} times, of a basis",
            "LaPy",
            lambda: basis.heat_kernel_signature(),
            lambda: lapy_heat(lam, Phi),
        ),
        Case(
            f"HKS, {TIMES} times, of a basis",
            "pyFM",
            lambda: basis.heat_kernel_signature(),
            lambda: np.asarray(pyFM.signatures.HKS(lam, Phi, t)),
        ),
        Case(
            f"WKS, {ENERGIES} energies, of a basis",
            "pyFM",
            lambda: basis.wave_kernel_signature(ENERGIES),
            lambda: pyfm_wave(lam, Phi),
        ),
    ]


def timed(work: Callable[[], Array]) -> tuple[float, Array]:
    """Call a function; return its seconds and its result."""
    begin = time.perf_counter()
    result = work()
    return time.perf_counter() - begin, result


def difference(ours: Array, theirs: Array) -> float:
    """Return the largest relative difference, leaving out the zero eigenvalue of the constant."""
    positive = ours > 0
    return float(np.abs(theirs[positive] / ours[positive] - 1).max())


def add_rows(table: Table, mesh: pathlib.Path, k: int, repetitions: int) -> None:
    """Measure a mesh."""
    V, F = load_arrays(mesh)
    used, corners = np.unique(F, return_inverse=True)  # LaPy has no unreferenced vertices
    V, F = V[used], corners.reshape(-1, 3)
    for case in cases(V, F, k):
        runs = [(timed(case.ours), timed(case.theirs)) for _ in range(repetitions)]
        ours, theirs = (min(run[who][0] for run in runs) for who in range(2))
        (_, our_result), (_, their_result) = runs[0]
        table.add_row(
            mesh.stem,
            str(len(V)),
            case.name,
            case.other,
            f"{ours:.3f}",
            f"{theirs:.3f}",
            f"{theirs / ours:.1f}",
            f"{difference(our_result, their_result):.0e}",
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("meshes", nargs="*", metavar="MESH", type=pathlib.Path, default=MESHES)
    parser.add_argument("-k", type=int, default=100, help="harmonics (100)")
    parser.add_argument("--repetitions", type=int, default=3, help="runs of each (3)")
    options = parser.parse_args()
    load()
    table = Table(box=MARKDOWN)
    for title in (
        "mesh",
        "vertices",
        "result",
        "other",
        "seconds",
        "other's",
        "ratio",
        "difference",
    ):
        justify: Any = "left" if title in ("mesh", "result", "other") else "right"
        table.add_column(title, justify=justify, no_wrap=True)
    for mesh in options.meshes:
        if mesh.is_file():
            print(mesh.name, file=sys.stderr, flush=True)
            add_rows(table, mesh, options.k, options.repetitions)
        else:
            print(f"skipped: no {mesh}", file=sys.stderr)
    Console(width=140).print(table)


if __name__ == "__main__":
    main()
