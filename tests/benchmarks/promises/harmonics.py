"""Eigenvalues: those of a sphere, and SciPy's of real meshes."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from functools import partial

import meshlab_spectral
import numpy as np
import scipy.sparse
import spectral_reference as reference
from basis_problem import Problem
from basis_solvers import scipy_superlu_symmetric
from meshlab_spectral import Harmonics

from promises.meshes import loaded, sphere
from promises.record import Promise, at_most, promise

# Largest relative error by subdivisions of the icosphere and degree l: that of D as in the paper,
# a third of the triangles' area at each vertex. It is of second order.
OF_SPHERE = {3: {2: 0.0057, 3: 0.0145, 4: 0.0265}, 4: {2: 0.00145, 3: 0.00365, 4: 0.0067}}
# 300 of the dragon take SciPy a quarter of a minute and more.
MESHES = {"data/dragon_40k.ply": 100, "data/fandisk.off": 300, "data/camelhead.off": 300}


def promises() -> Iterator[Promise]:
    yield from of_a_sphere()
    yield from of_real_meshes()


def of_a_sphere() -> Iterator[Promise]:
    """l (l + 1), 2 l + 1 times each: the spectrum of the unit sphere."""
    for subdivisions, errors in OF_SPHERE.items():
        for degree, bound in errors.items():
            yield promise(
                f"sphere, {subdivisions} subdivisions: relative error of l = {degree}",
                at_most(bound),
                partial(error_of_degree, subdivisions, degree),
            )


def of_real_meshes() -> Iterator[Promise]:
    """ "The same eigenvalues to 1e-11" as SciPy (tests/benchmarks/README.md); orthonormal."""
    for name, k in MESHES.items():
        yield promise(
            f"{k} eigenvalues, relative difference to SciPy: {name}",
            at_most(1e-11),
            partial(difference_to_scipy, name, k),
        )
        yield promise(
            f"{k} harmonics, off orthonormal: {name}",
            at_most(1e-8),
            partial(off_orthonormal, name, k),
        )


def error_of_degree(subdivisions: int, degree: int) -> float:
    basis = meshlab_spectral.manifold_harmonics(*sphere(subdivisions), 25)
    of_degree = basis.eigenvalues[degree**2 : (degree + 1) ** 2]
    return float(np.abs(of_degree / (degree * (degree + 1)) - 1).max())


@functools.lru_cache(maxsize=1)
def basis_of(name: str, k: int) -> Harmonics:
    return meshlab_spectral.manifold_harmonics(*loaded(name), k, "cotangent")


def difference_to_scipy(name: str, k: int) -> float:
    V, F = loaded(name)
    W, d = reference.matrices(V, F, "cotangent")
    found, _ = scipy_superlu_symmetric(Problem(V, F, scipy.sparse.csc_array(W), d), k)()
    constants = len(reference.components(len(V), F))
    found = np.sort(found)[constants:]
    return float(np.abs(basis_of(name, k).eigenvalues[constants:] / found - 1).max())


def off_orthonormal(name: str, k: int) -> float:
    basis = basis_of(name, k)
    gram = basis.harmonics.T @ (basis.masses[:, None] * basis.harmonics)
    return float(np.abs(gram - np.eye(k)).max())
