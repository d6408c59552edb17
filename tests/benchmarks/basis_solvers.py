"""The Python programs that bench_basis.py compares with; it runs each in a process of its own.

usage: basis_solvers.py NAME FOLDER K

Reads the problem from FOLDER, writes the pairs there and prints their cost as JSON, or
{"skipped": the reason} if a package is missing. Times exclude imports, reading and everything else
that a program does before it first sees k.

Every program has the best settings found for it on the 40,000-vertex dragon:

- eigsh in shift-invert mode. ARPACK's tol bounds the residual of the inverted operator, and
  eigenvectors are purified, so that residuals come out below 1e-10. From 1e-4 to 0 tol changes
  neither the number of solves nor the residuals: it is set to 1e-8.
- SuperLU "as it is" is what eigsh does when asked for sigma, with its own ncv, 2k + 1. The other
  two have ncv = 1.5k, which needs a tenth fewer solves and less time than 2k or 1.2k.
- SuperLU in symmetric mode, ordered by A + A^T and without pivoting, which a positive
  definite matrix allows: a solve takes half the time.
- CHOLMOD simplicial, METIS order: with one right-hand side its solves are faster than supernodal
  ones.
- LaPy has a fixed tolerance (0) and its own shift. It builds W and D itself, equal up to
  round-off.
"""

from __future__ import annotations

import json
import pathlib
import sys
import time
from collections.abc import Callable

from basis_problem import Array, Pairs, Problem, read_problem, write_pairs

Work = Callable[[], Pairs]
"""The part of a program that is timed."""

TOLERANCE = 1e-8
SEED = 1


def scipy_superlu(problem: Problem, k: int) -> Work:
    import scipy.sparse
    import scipy.sparse.linalg as linalg

    D = scipy.sparse.diags_array(problem.D, format="csc")
    return lambda: linalg.eigsh(
        problem.W, k, D, sigma=-problem.shift, tol=TOLERANCE, v0=start(problem)
    )


def scipy_superlu_symmetric(problem: Problem, k: int) -> Work:
    import scipy.sparse.linalg as linalg

    def factorized(A: object) -> Callable[[object], object]:
        options = {"SymmetricMode": True}
        return linalg.splu(
            A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options
        ).solve

    return eigsh_over(problem, k, factorized)


def scipy_cholmod(problem: Problem, k: int) -> Work:
    import sksparse.cholmod

    def factorized(A: object) -> Callable[[object], object]:
        return sksparse.cholmod.cholesky(A, mode="simplicial", ordering_method="metis")

    return eigsh_over(problem, k, factorized)


def lapy_superlu(problem: Problem, k: int) -> Work:
    return lapy_eigs(problem, k, use_cholmod=False)


def lapy_cholmod(problem: Problem, k: int) -> Work:
    return lapy_eigs(problem, k, use_cholmod=True)


def meshlab_spectral(problem: Problem, k: int) -> Work:
    """From arrays to arrays, through pymeshlab and the plugin: the time includes W and D."""
    import meshlab_spectral

    meshlab_spectral.load()

    def work() -> Pairs:
        found = meshlab_spectral.manifold_harmonics(problem.V, problem.F, k, laplacian="cotangent")
        return found.eigenvalues, found.harmonics

    return work


SOLVERS: dict[str, Callable[[Problem, int], Work]] = {
    work.__name__.replace("_", "-"): work
    for work in (
        meshlab_spectral,
        scipy_superlu,
        scipy_superlu_symmetric,
        scipy_cholmod,
        lapy_superlu,
        lapy_cholmod,
    )
}


def eigsh_over(
    problem: Problem, k: int, factorized: Callable[[object], Callable[[object], object]]
) -> Work:
    """Prepare eigsh with a chosen factorization of W + s D."""
    import scipy.sparse
    import scipy.sparse.linalg as linalg

    D = scipy.sparse.diags_array(problem.D, format="csc")

    def work() -> Pairs:
        inverse = linalg.LinearOperator(
            D.shape, factorized(scipy.sparse.csc_array(problem.W + problem.shift * D)), dtype=float
        )
        return linalg.eigsh(
            problem.W,
            k,
            D,
            sigma=-problem.shift,
            OPinv=inverse,
            ncv=min(len(problem.D), max(3 * k // 2, k + 20)),
            tol=TOLERANCE,
            v0=start(problem),
        )

    return work


def lapy_eigs(problem: Problem, k: int, use_cholmod: bool) -> Work:
    import lapy

    mesh = lapy.TriaMesh(problem.V, problem.F)
    solver = lapy.Solver(mesh, lump=True, use_cholmod=use_cholmod)
    return lambda: solver.eigs(k, rng=SEED)


def start(problem: Problem) -> Array:
    """Make the start vector of ARPACK."""
    import numpy as np

    return np.random.default_rng(SEED).uniform(-1, 1, len(problem.D))


def peak_megabytes() -> float:
    """Peak memory of this process; ru_maxrss would start from the peak of its parent."""
    status = pathlib.Path("/proc/self/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) / 1024


def main() -> None:
    name, folder, k = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
    try:
        work = SOLVERS[name](read_problem(folder), k)
    except ImportError as error:
        print(json.dumps({"skipped": str(error)}))
        return
    before = peak_megabytes()
    begin = time.perf_counter()
    pairs = work()
    seconds = time.perf_counter() - begin
    megabytes = peak_megabytes() - before
    write_pairs(folder, pairs)
    print(json.dumps({"seconds": seconds, "megabytes": megabytes}))


if __name__ == "__main__":
    main()
