"""Meshes to ask: those next to the repository, and some made here."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from typing import Any

import meshlab_spectral
import numpy as np
import pymeshlab
import scipy.sparse
from bench_denoise import vertex_normals
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.filters.arrays import mean_edge
from numpy.typing import NDArray

from promises.record import shared

Array = NDArray[np.float64]
Mesh = tuple[Array, NDArray[Any]]


@functools.lru_cache(maxsize=4)
def loaded(name: str) -> Mesh:
    """Read vertices and faces of a file in ../shared; not to be changed."""
    V, F = load_arrays(shared(name))
    V.flags.writeable = F.flags.writeable = False
    return V, F


def data_meshes() -> Iterator[str]:
    """Names of the meshes with faces in ../shared/data, smallest file first."""
    files = [file for file in shared("data").iterdir() if file.suffix != ".md"]
    for file in sorted(files, key=lambda file: file.stat().st_size):
        if "points" not in file.name:
            yield f"data/{file.name}"


@functools.cache
def default_run(name: str) -> tuple[Array, dict[str, Any]]:
    """Filter a mesh of ../shared with every parameter at its default: vertices, report."""
    X, report = meshlab_spectral.filter_mesh(*loaded(name))
    return X, report


def sphere(subdivisions: int) -> Mesh:
    """Return an icosphere; 642 vertices after 3 subdivisions, 2,562 after 4."""
    meshes = pymeshlab.MeshSet()
    meshes.create_sphere(radius=1, subdiv=subdivisions)
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix().copy(), mesh.face_matrix().copy()


def comet(rings: int = 40, around: int = 12, tail_radius: float = 0.12) -> Mesh:
    """Return an uneven sphere with a thin tail along z: a closed surface of 482 vertices."""
    half = rings // 2
    polar = np.linspace(0.15, np.pi - 0.12, half)
    z = np.concatenate([-np.cos(polar), np.linspace(1.05, 3, rings - half)])
    radius = np.concatenate([np.sin(polar), np.full(rings - half, tail_radius)])
    turn = 2 * np.pi * np.arange(around) / around
    circles = radius[:, None, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    V = np.column_stack([circles.reshape(-1, 2), np.repeat(z, around)])
    V = np.vstack([V, [0, 0, -1], [0, 0, 3.1]])
    V *= (1 + 0.1 * np.sin(3 * V[:, 0] + 1) * np.cos(4 * V[:, 1]))[:, None]
    grid = np.arange(rings * around).reshape(rings, around)
    left, right = grid, np.roll(grid, -1, axis=1)
    quads = [left[:-1], right[:-1], right[1:], left[1:]]
    a, b, c, d = (corner.ravel() for corner in quads)
    bottom, top = (np.full(around, rings * around + pole) for pole in (0, 1))
    triangles = [(a, b, c), (a, c, d), (bottom, right[0], left[0]), (top, left[-1], right[-1])]
    return V, np.vstack([np.column_stack(corners) for corners in triangles])


def open_half(mesh: Mesh) -> Mesh:
    """Return the half of a mesh below the median of z: a surface with a boundary."""
    V, F = mesh
    below = V[:, 2] < np.median(V[:, 2])
    used, corners = np.unique(F[below[F].all(axis=1)], return_inverse=True)
    return V[used], corners.reshape(-1, 3)


def divided(mesh: Mesh, times: int) -> Mesh:
    """Divide every triangle into four at the midpoints of its edges, some times."""
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(*mesh))
    if times:
        meshes.meshing_surface_subdivision_midpoint(
            iterations=times, threshold=pymeshlab.PureValue(0)
        )
    fine = meshes.current_mesh()
    return fine.vertex_matrix().copy(), fine.face_matrix().copy()


def neighbours(F: NDArray[Any], count: int) -> scipy.sparse.csr_array:
    """Return the n x n matrix that averages over each vertex and its neighbours."""
    ends = (F.ravel(), np.roll(F, 1, axis=1).ravel())
    one_way = scipy.sparse.coo_array((np.ones(F.size), ends), shape=(count, count))
    joined = ((one_way + one_way.T) != 0).astype(float) + scipy.sparse.eye_array(count)
    return scipy.sparse.csr_array(scipy.sparse.diags_array(1 / joined.sum(axis=1)) @ joined)


def along_normals(mesh: Mesh, heights: Array) -> Array:
    """Return the displacement of the vertices along their normals, in mean edges."""
    V, F = mesh
    return vertex_normals(V, F) * (mean_edge(V, F) * heights)[:, None]


def diagonal(V: Array) -> float:
    """Return the diagonal of the bounding box."""
    return float(np.linalg.norm(np.ptp(V, axis=0)))


def largest_distance(X: Array, Y: Array) -> float:
    """Return the largest distance between vertices of the same number."""
    return float(np.linalg.norm(X - Y, axis=1).max())
