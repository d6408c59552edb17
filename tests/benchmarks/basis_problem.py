"""The eigenproblem that bench_basis.py gives to every program, and the check of a result.

Arrays are raw binary files in a folder, one array each, as bench_basis.cpp writes them.
"""

from __future__ import annotations

import pathlib
from dataclasses import dataclass

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

Array = NDArray[np.float64]

Pairs = tuple[Array, Array]
"""k eigenvalues and n x k eigenvectors, in any order and of any norm."""


@dataclass(frozen=True)
class Problem:
    """W phi = lambda D phi of a mesh of n vertices V and triangles F; D the diagonal."""

    V: Array
    F: NDArray[np.int32]
    W: scipy.sparse.csc_array
    D: Array

    @property
    def shift(self) -> float:
        """Mean spacing of eigenvalues by Weyl's law; solvers factorize W + shift D.

        Proportional to the spectrum, whatever the unit of length, and far above round-off.
        """
        return float(4 * np.pi / self.D.sum())


def read_problem(folder: pathlib.Path) -> Problem:
    """Read what `bench_basis matrices` wrote."""
    D = np.fromfile(folder / "D")
    columns = (
        np.fromfile(folder / "W.values"),
        np.fromfile(folder / "W.rows", np.int32),
        np.fromfile(folder / "W.starts", np.int32),
    )
    return Problem(
        np.fromfile(folder / "V").reshape(-1, 3),
        np.fromfile(folder / "F", np.int32).reshape(-1, 3),
        scipy.sparse.csc_array(columns, shape=(len(D), len(D))),
        D,
    )


def write_pairs(folder: pathlib.Path, pairs: Pairs) -> None:
    """Write a result, vector by vector."""
    lam, Phi = pairs
    lam.astype(float).tofile(folder / "lambda")
    np.ascontiguousarray(Phi.T, dtype=float).tofile(folder / "Phi")


def read_pairs(folder: pathlib.Path, D: Array) -> Pairs:
    """Read a result: eigenvalues ascending, eigenvectors of D-norm 1."""
    lam = np.fromfile(folder / "lambda")
    Phi = np.fromfile(folder / "Phi").reshape(len(lam), len(D)).T
    order = np.argsort(lam)
    lam, Phi = lam[order], Phi[:, order]
    return lam, Phi / np.sqrt(D @ Phi**2)


@dataclass(frozen=True)
class Check:
    """The errors of a result of k pairs."""

    residual: float
    """Largest |D^-1/2 (W phi - lambda D phi)| / lambda of all but the constant modes."""

    difference: float
    """Largest relative error of an eigenvalue, against the reference's of the same index."""

    missing: int
    """Number of dimensions that it lacks of the span of the k lowest harmonics."""


def check(problem: Problem, constants: int, k: int, found: Pairs, reference: Pairs) -> Check:
    """Measure a result, in the same way for every program.

    Parameters
    ----------
    constants
        Number of constant modes, whose eigenvalue 0 has no relative error.
    k
        Number of pairs requested; only the lowest k are checked.
    found, reference
        As from `read_pairs`. The reference may have more than k pairs, where k would split equal
        eigenvalues; their number is certified by inertia.
    """
    lam, Phi = found[0][:k], found[1][:, :k]
    root = np.sqrt(problem.D)
    R = problem.W @ Phi - problem.D[:, None] * Phi * lam
    residuals = np.linalg.norm(R / root[:, None], axis=0)[constants:] / lam[constants:]
    common = min(len(lam), len(reference[0]))
    compared = slice(constants, common)
    differences = np.abs(lam[compared] / reference[0][compared] - 1)
    # A duplicate, or a pair that is not an eigenpair, adds nothing to the common span.
    overlaps = np.linalg.svd(
        (root[:, None] * reference[1]).T @ (root[:, None] * Phi), compute_uv=False
    )
    expected = min(k, len(reference[0]))
    return Check(residuals.max(), differences.max(), expected - int(np.sum(overlaps > 0.99)))
