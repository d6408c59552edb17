"""Three hundred harmonics of real meshes agree with those of ARPACK, and none is missing.

Both sides solve W phi = lambda D phi with the cotangent Laplacian, whose entries are sums of a few
cotangents: the matrices that these tests build themselves (spectral_reference) differ from the
plugin's by round-off alone. That is what makes 1e-8 a statement about the eigensolver.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pymeshlab
import scipy.sparse
import scipy.sparse.linalg
import spectral_reference as reference
from helpers import mesh_set_of
from numpy.typing import NDArray
from shared_types import Arrays, Decimated, Record, SharedMesh

Array = NDArray[np.float64]

K = 300
AGREEMENT_OF_EIGENVALUES = 1e-8  # relative to each
AGREEMENT_OF_EIGENSPACES = 1e-6  # sine of the largest angle between them
RESIDUAL = 1e-8

CLUSTER_GAP = 1e-3
"""Relative gap of eigenvalues that separates two clusters.

A relative residual r turns an eigenspace by about r / gap: the plugin's residuals at multiple
eigenvalues, 1e-9, allow 1e-6 across this gap but not across a smaller one. Within a cluster only
the whole space is so well defined. On the meshes without symmetry nearly every eigenvalue is a
cluster of its own.
"""


def arpack(W: scipy.sparse.csc_array, d: Array, k: int) -> tuple[Array, Array]:
    """Return the k lowest eigenpairs by shift-invert; the eigenvectors are D-orthonormal."""
    shift = 4 * np.pi / d.sum()  # the mean spacing of eigenvalues (Weyl)
    mass = scipy.sparse.diags_array(d, format="csc")
    factor = scipy.sparse.linalg.splu(
        scipy.sparse.csc_array(W + shift * mass),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    lam, Phi = scipy.sparse.linalg.eigsh(
        W,
        k,
        mass,
        sigma=-shift,
        OPinv=scipy.sparse.linalg.LinearOperator(W.shape, factor.solve, dtype=float),
        v0=np.random.default_rng(1).uniform(-1, 1, len(d)),
    )
    order = np.argsort(lam)
    return lam[order], Phi[:, order]


def clusters(lam: Array, k: int) -> list[slice]:
    """Group eigenvalues between gaps; return the groups that end within the first k."""
    ends = np.flatnonzero(np.diff(lam) > CLUSTER_GAP * lam[1:]) + 1
    groups = [slice(int(a), int(b)) for a, b in zip([0, *ends[:-1]], ends, strict=True)]
    return [group for group in groups if group.stop <= k]


def sine_of_angle(A: Array, B: Array, d: Array) -> float:
    """Sine of the largest principal angle between the spans of D-orthonormal columns.

    Computed as the norm of the part of B outside A: the cosine loses angles below 1e-8.
    """
    rest = B - A @ (A.T @ (d[:, None] * B))
    return float(np.linalg.norm(np.sqrt(d)[:, None] * rest, ord=2))


def loaded(path: Path) -> pymeshlab.MeshSet:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(path))
    mesh_set.meshing_remove_unreferenced_vertices()
    return mesh_set


def assert_agrees_with_arpack(mesh_set: pymeshlab.MeshSet, k: int, record: Record) -> Array:
    """Compare the filter's basis with ARPACK's; return ARPACK's eigenvalues."""
    report = mesh_set.compute_scalar_manifold_harmonic_per_vertex(
        basis_size=k, laplacian="cotangent", store_basis=True
    )
    mesh = mesh_set.current_mesh()
    V, F = mesh.vertex_matrix(), mesh.face_matrix()
    basis = np.column_stack(
        [mesh.vertex_custom_scalar_attribute_array(f"harmonic_{i}") for i in range(k)]
    )
    W, d = reference.matrices(V, F, "cotangent")
    constants = len(reference.components(len(V), F))

    # The certificate. The count may exceed k: it includes the whole last group of equal ones.
    assert len(report["residuals"]) == len(report["eigenvalues"]) == k
    assert report["residuals"].max() < RESIDUAL
    whole = int(report["inertia_count"])
    assert whole >= k

    lam, Phi = arpack(scipy.sparse.csc_array(W), d, whole + 1)
    assert lam[whole] > lam[whole - 1] * (1 + AGREEMENT_OF_EIGENVALUES), "the count cuts a group"
    np.testing.assert_array_equal(report["eigenvalues"][:constants], 0)
    waves = slice(constants, k)
    difference = np.abs(report["eigenvalues"][waves] / lam[waves] - 1).max()
    record("largest_relative_difference_of_eigenvalues", difference)
    assert difference < AGREEMENT_OF_EIGENVALUES

    groups = clusters(np.where(np.arange(len(lam)) < constants, 0, lam), k)
    angles = [sine_of_angle(Phi[:, group], basis[:, group], d) for group in groups]
    record("largest_sine_of_an_angle_of_eigenspaces", max(angles))
    record("clusters", len(groups))
    assert groups[-1].stop > k / 2, "too few groups to mean anything"
    assert max(angles) < AGREEMENT_OF_EIGENSPACES
    return lam


def test_a_basis_of_seven_components_agrees_with_arpack(
    shared_mesh: SharedMesh, record_property: Record
) -> None:
    assert_agrees_with_arpack(loaded(shared_mesh("greek_helmet.obj")), K, record_property)


def test_a_basis_of_a_sample_agrees_with_arpack(
    sample_name: str, decimated: Decimated, record_property: Record
) -> None:
    assert_agrees_with_arpack(mesh_set_of(*decimated(sample_name, 3_000)), K, record_property)


def test_no_harmonic_of_a_sphere_is_missing(record_property: Record) -> None:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.create_sphere(radius=1, subdiv=4)
    degrees = np.repeat(np.arange(13), 2 * np.arange(13) + 1)
    lam = assert_agrees_with_arpack(mesh_set, len(degrees), record_property)
    # lambda = n (n + 1), 2 n + 1 times; the mesh shifts it by less than half the gap to the next.
    found = np.rint(np.sqrt(lam[: len(degrees)] + 0.25) - 0.5)
    np.testing.assert_array_equal(found, degrees)


def cube(cells: int) -> Arrays:
    """Make the surface of [0, cells]^3, of squares cut in two."""
    faces, corners = [], []
    grid = np.arange(cells + 1)
    a, b = (axis.ravel() for axis in np.meshgrid(grid, grid, indexing="ij"))
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    for axis in range(3):
        for side in (0, cells):
            points = np.insert(np.column_stack([a, b]), axis, side, axis=1)
            offset = len(corners) * len(points)
            corners.append(points)
            for triangle in ((0, cells + 1, cells + 2), (0, cells + 2, 1)):
                faces.append(offset + first[:, None] + np.array(triangle))
    V, place = np.unique(np.vstack(corners), axis=0, return_inverse=True)
    return V.astype(float), place.ravel()[np.vstack(faces)]


def test_no_harmonic_of_a_cube_is_missing(record_property: Record) -> None:
    V, F = cube(20)
    lam = assert_agrees_with_arpack(mesh_set_of(V, F), K, record_property)
    doubles = np.sum(np.diff(lam) < 1e-6 * lam[1:])
    assert doubles > K / 4, "a cube has many equal eigenvalues"
