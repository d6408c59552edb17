"""Manifold harmonics of a mesh as NumPy arrays; projections, filters and shape descriptors."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import ArrayError, FilterError
from meshlab_spectral.filters.arrays import lumped_areas, mesh_arrays, real_numbers
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone
from meshlab_spectral.filters.option_types import checked_count
from meshlab_spectral.filters.options import BasisOptions, Boundary, LaplacianKind
from meshlab_spectral.filters.progress import Progress
from meshlab_spectral.filters.running import run

Array = NDArray[np.float64]

DEFAULT_TIMES = 16
# Wave kernel (Aubry et al.): standard deviation of each distribution, in steps between energies;
# distance of the first and last energy from the ends of the spectrum, in standard deviations.
_DEVIATION, _MARGIN = 7, 2


@dataclass(frozen=True, eq=False)
class Harmonics:
    """The k lowest eigenpairs of a mesh's Laplacian, ``W phi = lambda D phi``.

    With Phi the harmonics and D the masses, a function f at the vertices has coefficients
    ``c = Phi^T D f``, and ``Phi c`` is its projection, the nearest function in the D-norm.

    Attributes
    ----------
    eigenvalues
        k values lambda, ascending, 1 / length^2; exactly 0 for the constant function of each
        component without a fixed boundary.
    harmonics
        n x k, column i for eigenvalue i, 1 / length. Orthonormal with the masses as weights,
        ``Phi.T @ (masses[:, None] * Phi) = I``; 0 at unreferenced vertices and fixed boundaries.
        The entry of largest magnitude in each column is positive.
    masses
        Areas of the n vertices, the diagonal of D, length^2: a third of the area of the incident
        triangles; with the uniform Laplacian, the mean of these.
    """

    eigenvalues: Array
    harmonics: Array
    masses: Array

    def __iter__(self) -> Iterator[Array]:
        """Unpack as ``eigenvalues, harmonics = basis``, as eigensolvers return them."""
        return iter((self.eigenvalues, self.harmonics))

    def __repr__(self) -> str:
        waves = self.frequencies[self.eigenvalues > 0]
        longest, shortest = (2 * np.pi / waves[[0, -1]]) if len(waves) else (np.inf, np.inf)
        return (
            f"Harmonics({len(self.eigenvalues)} of a mesh of {len(self.masses)} vertices, "
            f"wavelengths {longest:.4g} to {shortest:.4g})"
        )

    @property
    def frequencies(self) -> Array:
        """The k square roots of the eigenvalues, 2 pi over wavelength, radians per length unit."""
        roots: Array = np.sqrt(self.eigenvalues)
        return roots

    def project(self, f: ArrayLike) -> Array:
        """Compute the coefficients of functions in the basis, ``c = Phi^T D f``.

        Parameters
        ----------
        f
            n values at the vertices, or n x c for c functions such as coordinates; finite.

        Returns
        -------
        array
            k coefficients, or k x c, in the unit of f times length.

        Raises
        ------
        ArrayError
            When f does not have a finite value for each vertex.

        Examples
        --------
        >>> energy = (basis.project(vertices) ** 2).sum(axis=1)
        """
        values = _rows("f", f, len(self.masses), "vertex")
        coefficients: Array = self.harmonics.T @ (self.masses * values.T).T
        return coefficients

    def reconstruct(self, c: ArrayLike) -> Array:
        """Compute functions from their coefficients, ``f = Phi c``.

        ``reconstruct(project(f))`` is the projection of f onto the basis.

        Parameters
        ----------
        c
            k coefficients, or k x c for c functions; finite.

        Returns
        -------
        array
            n values at the vertices, or n x c.

        Raises
        ------
        ArrayError
            When c does not have a finite value for each harmonic.

        Examples
        --------
        >>> coarse = basis.reconstruct(basis.project(vertices))
        """
        f: Array = self.harmonics @ _rows("c", c, len(self.eigenvalues), "harmonic")
        return f

    def filter(self, f: ArrayLike, gain: Callable[[Array], ArrayLike]) -> Array:
        """Filter functions within the basis, ``Phi diag(F(omega)) Phi^T D f``.

        Constants have gain 1, as in every filter of this package: f keeps its mean over each
        component without a fixed boundary. The part of f outside the basis is dropped;
        `filter_scalars` filters the whole spectrum.

        Parameters
        ----------
        f
            n values at the vertices, or n x c for c functions; finite.
        gain
            The transfer function F. Called once, with the positive frequencies of the basis,
            ascending, in radians per length unit: 2 pi / feature size. Returns a finite gain for
            each, or one for all; a negative gain flips the sign.

        Returns
        -------
        array
            n filtered values, or n x c; 0 at unreferenced vertices and fixed boundaries.

        Raises
        ------
        ArrayError
            When f does not have a finite value for each vertex, or `gain` does not return finite
            gains; names the frequency.

        Examples
        --------
        >>> cutoff = 2 * np.pi / 0.05
        >>> smooth = basis.filter(curvature, lambda omega: np.exp(-((omega / cutoff) ** 2)))
        """
        waves = self.eigenvalues > 0
        omega = self.frequencies[waves]
        F = real_numbers(gain(omega.copy()), "gains")
        if F.shape not in ((), omega.shape):
            raise ArrayError(
                f"gain returns shape {F.shape} for {len(omega)} frequencies: return a gain for each"
            )
        gains = np.ones(len(waves))
        gains[waves] = F
        if not np.isfinite(gains).all():
            wrong = np.flatnonzero(~np.isfinite(gains))[0]
            raise ArrayError(
                f"gain({self.frequencies[wrong]:g}) = {gains[wrong]}: return finite gains at all "
                "positive frequencies"
            )
        return self.reconstruct((gains * self.project(f).T).T)

    def heat_kernel_signature(self, times: ArrayLike | None = None) -> Array:
        """Compute the heat kernel signature of every vertex.

        J. Sun, M. Ovsjanikov, L. Guibas: A Concise and Provably Informative Multi-Scale Signature
        Based on Heat Diffusion, SGP 2009.

        ``h_t(x) = sum_i exp(-lambda_i t) phi_i(x)^2``: the fraction of heat placed at x that is
        still there at time t, per area. Small times capture curvature and thin parts, large times
        the overall shape; bending without stretching does not change it.

        Parameters
        ----------
        times
            T times, >= 0, length^2; heat spreads over a distance of about sqrt(4 t). By default 16,
            geometrically spaced from ``4 ln 10 / lambda`` of the last eigenvalue to that of the
            first positive one, as in the paper, so they scale with the mesh. Smaller times need a
            larger basis.

        Returns
        -------
        array
            n x T values, >= 0, 1 / length^2.

        Raises
        ------
        ArrayError
            When `times` are not finite and >= 0, or all harmonics are constant, so that there are
            no default times.

        Examples
        --------
        >>> signature = manifold_harmonics(V, F, 300).heat_kernel_signature()
        >>> distance = np.linalg.norm(np.log(signature) - np.log(signature[0]), axis=1)
        """
        if times is None:
            if not (self.eigenvalues > 0).any():
                raise ArrayError(
                    f"all {len(self.eigenvalues)} harmonics are constant: compute more, or pass "
                    "times"
                )
            t = heat_times(self.eigenvalues, DEFAULT_TIMES)
        else:
            t = real_numbers(times, "times")
            if t.ndim != 1 or len(t) == 0 or not (np.isfinite(t) & (t >= 0)).all():
                raise ArrayError(f"times = {times}: pass a list of finite numbers from 0 on")
        signature: Array = self.harmonics**2 @ np.exp(-np.outer(self.eigenvalues, t))
        return signature

    def wave_kernel_signature(self, count: int = 100) -> Array:
        """Compute the wave kernel signature of every vertex.

        M. Aubry, U. Schlickewei, D. Cremers: The Wave Kernel Signature: A Quantum Mechanical
        Approach to Shape Analysis, ICCV Workshops 2011.

        ``WKS(x, e) = C_e sum_i phi_i(x)^2 exp(-(e - log lambda_i)^2 / (2 sigma^2))``, where C_e
        makes the weights sum to 1: the probability density of a particle of energy about exp(e) at
        x. Unlike the heat kernel signature it separates sizes: an energy is a band of wavelengths.

        Parameters
        ----------
        count
            Number T of energies e. They are evenly spaced by delta from ``log lambda + 2 sigma`` of
            the first positive eigenvalue to ``log lambda - 2 sigma`` of the last one, with
            ``sigma = 7 delta``, as in the paper.

        Returns
        -------
        array
            n x T values, >= 0, 1 / length^2, from low energies to high ones; every column
            integrates to 1 over the surface, ``masses @ signature = 1``.

        Raises
        ------
        OptionError
            When `count` is not a positive integer.
        ArrayError
            When the basis has fewer than two different positive eigenvalues.

        Examples
        --------
        >>> signature = manifold_harmonics(V, F, 300).wave_kernel_signature()
        """
        count = checked_count("count", count)
        positive = np.unique(self.eigenvalues[self.eigenvalues > 0])
        if len(positive) < 2:
            raise ArrayError(
                "energies lie between two different positive eigenvalues, of which the basis has "
                f"{len(positive)}: compute more harmonics"
            )
        e, sigma = wave_energies(self.eigenvalues, count)
        waves = self.eigenvalues > 0
        exponent = (np.log(self.eigenvalues[waves])[:, None] - e) ** 2 / (2 * sigma**2)
        # Divide by a factor that C_e cancels: else weights of an energy in a gap would underflow.
        f_e = np.exp(exponent.min(axis=0) - exponent)
        signature: Array = self.harmonics[:, waves] ** 2 @ (f_e / f_e.sum(axis=0))
        return signature


def heat_times(lam: Array, count: int) -> Array:
    """Sample times for the ascending eigenvalues `lam`, from fine to coarse, as Sun et al. do.

    At the first time the last harmonic has decayed to 1e-4, at the last all but the constants.
    """
    positive = lam[lam > 0]
    return np.geomspace(4 * np.log(10) / positive[-1], 4 * np.log(10) / positive[0], count)


def wave_energies(lam: Array, count: int) -> tuple[Array, float]:
    """Sample energies, logarithms of eigenvalues, and their sigma, as Aubry et al. do.

    The first and the last one lie 2 sigma inside the spectrum, and so does most of every
    distribution.
    """
    log_lam = np.log(lam[lam > 0])
    first, last = log_lam[0], log_lam[-1]
    # last - first = (count - 1) delta + 2 * 2 sigma
    delta = (last - first) / (count - 1 + 2 * _MARGIN * _DEVIATION)
    sigma = _DEVIATION * delta
    return first + _MARGIN * sigma + delta * np.arange(count), float(sigma)


@takes_mesh_alone
def manifold_harmonics(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    basis_size: int = BasisOptions.basis_size,
    laplacian: LaplacianKind = "intrinsic delaunay",
    boundary: Boundary = "free",
    *,
    progress: Progress | bool | None = None,
    threads: int | None = None,
) -> Harmonics:
    """Compute the lowest-frequency manifold harmonics of a mesh.

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `filter_mesh`.
    basis_size
        Number of harmonics k, constants included; less than the number of vertices not fixed.
    laplacian
        "intrinsic delaunay" works with any triangles; "cotangent" needs non-degenerate ones;
        "uniform" uses the connectivity only.
    boundary
        "free": Neumann conditions at the boundary of an open surface; "fixed": zero there.
    progress, threads
        As for `filter_mesh`.

    Returns
    -------
    Harmonics
        Eigenvalues, eigenfunctions and vertex areas, in the units of the mesh.

    Raises
    ------
    SpectralError
        As from `filter_mesh`: an OptionError when `basis_size` is not a positive integer, a
        FilterError when the mesh has too few vertices for it.

    Examples
    --------
    >>> basis = manifold_harmonics(V, F, 50)
    >>> smooth = basis.reconstruct(basis.project(V))
    """
    options = BasisOptions(basis_size=basis_size, laplacian=laplacian, boundary=boundary)
    V, F = mesh_arrays(mesh_or_vertices, faces)
    parameters = {"mode": 0, **options.core_parameters()}  # mode 0 is in every basis
    done = run(options.FILTER, V, F, parameters, progress=progress, threads=threads)
    Phi = done.basis
    assert Phi is not None
    masses = _equal_areas(V, F, Phi) if laplacian == "uniform" else lumped_areas(V, F)
    return Harmonics(done.report["eigenvalues"], Phi, masses)


@takes_mesh_alone
def shape_dna(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    count: int = 50,
    normalize: bool = True,
    laplacian: LaplacianKind = "intrinsic delaunay",
    boundary: Boundary = "free",
    *,
    progress: Progress | bool | None = None,
    threads: int | None = None,
) -> NDArray[np.float64]:
    """Compute the Shape-DNA of a mesh, its lowest eigenvalues.

    M. Reuter, F.-E. Wolter, N. Peinecke: Laplace-Beltrami Spectra as "Shape-DNA" of Surfaces and
    Solids, Computer-Aided Design 38(4), 2006.

    Shapes that differ by a rigid motion or by bending without stretching have the same Shape-DNA,
    up to discretization error. The distance between two shapes is that between their Shape-DNAs.

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `manifold_harmonics`.
    count
        Number of eigenvalues, including the zeros of constants; at least 2, and less than the
        number of vertices not fixed.
    normalize
        Whether to multiply by the area of the surface, so that scale does not matter.
    laplacian, boundary, progress, threads
        As for `manifold_harmonics`.

    Returns
    -------
    array
        `count` eigenvalues lambda, ascending: ``lambda * area``, dimensionless, which grow by 4 pi
        on average (Weyl's law); or lambda itself, 1 / length^2.

    Raises
    ------
    SpectralError
        As from `manifold_harmonics`: an OptionError when `count` is not an integer >= 2.

    Examples
    --------
    >>> dna = shape_dna(V, F)
    >>> np.linalg.norm(dna - shape_dna(other_V, other_F))
    """
    basis_size = checked_count("count", count, least=2)
    try:
        basis = manifold_harmonics(
            mesh_or_vertices,
            faces,
            basis_size,
            laplacian,
            boundary,
            progress=progress,
            threads=threads,
        )
    except FilterError as error:  # with this function's parameter name
        raise type(error)(str(error).replace("basis_size", "count")) from error
    # The paper's factor is area^(2 / dimension), and the dimension of a surface is 2.
    return basis.eigenvalues * basis.masses.sum() if normalize else basis.eigenvalues


def _rows(name: str, values: ArrayLike, count: int, what: str) -> Array:
    """Validate a number, or a row of numbers, for each vertex or harmonic."""
    rows = real_numbers(values, name)
    if rows.ndim not in (1, 2) or len(rows) != count:
        raise ArrayError(
            f"{name} has shape {rows.shape}: pass {count} values, one for each {what}, or a matrix "
            f"with {count} rows"
        )
    if not np.isfinite(rows).all():
        wrong = np.argwhere(~np.isfinite(rows))[0, 0]
        raise ArrayError(f"{name} is not finite at {what} {wrong}: pass finite values")
    return rows


def _equal_areas(V: Array, F: NDArray[Any], Phi: Array) -> Array:
    """Return the vertex areas of the uniform Laplacian: their mean, 0 at unreferenced vertices.

    For the plugin, copies of a vertex along a seam are one vertex: they share its area. Unlike
    vertices of two parts that only touch, they have bitwise equal harmonics.
    """
    used = np.unique(F)
    told_apart_by = np.column_stack([V, Phi.sum(axis=1)])[used]
    one, of, copies = np.unique(told_apart_by, axis=0, return_inverse=True, return_counts=True)
    areas = np.zeros(len(V))
    areas[used] = lumped_areas(V, F).sum() / len(one) / copies[of.ravel()]
    return areas
