"""Manifold harmonics of meshes given as arrays, from the plugin."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.calling import call_filter
from meshlab_spectral.plugin import load

_FILTER_NAME = "compute_scalar_manifold_harmonic_per_vertex"


def manifold_harmonics(
    V: NDArray[np.float64], F: NDArray[np.int64], basis_size: int
) -> NDArray[np.float64]:
    """Compute the eigenfunctions of a mesh's Laplacian with the lowest eigenvalues.

    Parameters
    ----------
    V, F
        n x 3 coordinates, m x 3 indices of the corners of triangles.
    basis_size
        Their number k, below n.

    Returns
    -------
    array
        n x k, by ascending eigenvalue; the first is the constant.

    Raises
    ------
    FilterError
        When the filter refuses the mesh or the number.
    """
    load()
    import pymeshlab

    mesh_set = pymeshlab.MeshSet()
    mesh_set.add_mesh(pymeshlab.Mesh(V, F))
    call_filter(mesh_set, _FILTER_NAME, {"basis_size": basis_size, "store_basis": True})
    mesh = mesh_set.current_mesh()
    columns = [
        mesh.vertex_custom_scalar_attribute_array(f"harmonic_{mode}") for mode in range(basis_size)
    ]
    return np.column_stack(columns)


def lumped_areas(V: NDArray[np.float64], F: NDArray[np.int64]) -> NDArray[np.float64]:
    """Area of every vertex, a third of that of the triangles at it: the diagonal of D."""
    a, b, c = (V[F[:, corner]] for corner in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    lumped = np.zeros(len(V))
    np.add.at(lumped, F, areas[:, None] / 3)
    return lumped
