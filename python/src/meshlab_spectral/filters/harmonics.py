"""Manifold harmonics of a mesh, as NumPy arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import equal_areas, lumped_areas, mesh_arrays
from meshlab_spectral.filters.calling import call_filter
from meshlab_spectral.filters.options import Boundary, LaplacianKind, checked_basis_size
from meshlab_spectral.plugin.loading import load

DEFAULT_BASIS_SIZE = 100

_FILTER_NAME = "compute_scalar_manifold_harmonic_per_vertex"


@dataclass(frozen=True, eq=False)
class Harmonics:
    """The k lowest eigenpairs of a mesh's Laplacian, ``W phi = lambda D phi``.

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
        Areas of the n vertices, the diagonal of D, length^2: a third of their incident triangles;
        with the uniform Laplacian the mean of these.
    """

    eigenvalues: NDArray[np.float64]
    harmonics: NDArray[np.float64]
    masses: NDArray[np.float64]

    @property
    def frequencies(self) -> NDArray[np.float64]:
        """Square roots of the eigenvalues, radians per length unit; wavelengths are 2 pi / them."""
        roots: NDArray[np.float64] = np.sqrt(self.eigenvalues)
        return roots


def manifold_harmonics(
    vertices: ArrayLike,
    faces: ArrayLike,
    basis_size: int = DEFAULT_BASIS_SIZE,
    laplacian: LaplacianKind = "intrinsic delaunay",
    boundary: Boundary = "free",
) -> Harmonics:
    """Compute the manifold harmonics of lowest frequency of a mesh.

    Parameters
    ----------
    vertices
        n x 3 coordinates, finite.
    faces
        m x 3 indices of the corners of triangles, from 0 to n - 1; any topology.
    basis_size
        Number of harmonics k, constants included; less than the number of vertices not fixed.
    laplacian
        "intrinsic delaunay" works with any triangles; "cotangent" needs non-degenerate ones;
        "uniform" looks at the connections only.
    boundary
        "free": Neumann conditions at the boundary of an open surface; "fixed": zero there.

    Returns
    -------
    Harmonics
        Eigenvalues, eigenfunctions and vertex areas, in the units of the mesh.

    Raises
    ------
    ValueError
        When an array has the wrong shape or type, or an index is out of range.
    OptionError
        When `laplacian` or `boundary` is unknown, or `basis_size` is not a positive integer.
    FilterError
        When the mesh has no faces, no area, non-finite coordinates, or too few vertices for
        `basis_size`.
    PluginError
        When the plugin cannot be loaded.

    Examples
    --------
    >>> basis = manifold_harmonics(V, F, 50)
    >>> spectrum = basis.harmonics.T @ (basis.masses[:, None] * V)
    """
    return compute(*mesh_arrays(vertices, faces), basis_size, laplacian, boundary)


def compute(
    V: NDArray[np.float64],
    F: NDArray[Any],
    basis_size: int,
    laplacian: LaplacianKind,
    boundary: Boundary,
    verbose: bool = False,
) -> Harmonics:
    """Compute the harmonics of validated arrays. With `verbose`, MeshLab writes its log."""
    basis_size = checked_basis_size(basis_size)
    for name, value, kind in (
        ("laplacian", laplacian, LaplacianKind),
        ("boundary", boundary, Boundary),
    ):
        if value not in get_args(kind):
            raise OptionError(f"{name} = {value}: choose {', '.join(get_args(kind))}")
    load()
    import pymeshlab

    mesh_set = pymeshlab.MeshSet(verbose=verbose)
    mesh_set.add_mesh(pymeshlab.Mesh(V, F))
    parameters = {
        "mode": 0,  # in every basis
        "basis_size": basis_size,
        "store_basis": True,
        "laplacian": laplacian,
        "boundary": boundary,
    }
    report = call_filter(mesh_set, _FILTER_NAME, parameters)
    mesh = mesh_set.current_mesh()
    columns = [
        mesh.vertex_custom_scalar_attribute_array(f"harmonic_{mode}") for mode in range(basis_size)
    ]
    masses = equal_areas(V, F) if laplacian == "uniform" else lumped_areas(V, F)
    return Harmonics(report["eigenvalues"].copy(), np.column_stack(columns), masses)
