"""Small meshes made by formulas, to try things on: arrays, or files with `save`.

>>> from meshlab_spectral import denoise_mesh, examples
>>> V, F = examples.scan()
>>> clean, report = denoise_mesh(V, F)
>>> examples.save("scan.ply", V, F)
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.formats.normals import vertex_normals
from meshlab_spectral.formats.ply_elements import write_ply

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]


def scan(noise: float = 0.3, *, seed: int = 0) -> Mesh:
    """Return a closed shape with bumps, as a scanner sees it: 10,242 vertices.

    Parameters
    ----------
    noise
        Standard deviation of every vertex along its normal, in mean edges; 0: the truth.
    seed
        Of the random numbers.
    """
    V, F = _sphere(5)
    x, y, z = V.T
    bumps = 0.12 * np.sin(6 * x) * np.sin(5 * y + 1) * np.cos(4 * z) + 0.15 * x * y
    V = V * np.array([1.0, 0.8, 1.2]) * (1 + bumps)[:, None]
    return _noisy(V, F, noise, seed), F


def part(noise: float = 0.0, *, seed: int = 0) -> Mesh:
    """Return a machine part with flat faces and sharp edges: a step, 5,402 vertices.

    Parameters are those of `scan`.
    """
    cells = 30
    i, j, square = _squares(cells)
    points: list[NDArray[np.int64]] = []
    faces: list[NDArray[np.int64]] = []
    for axis in range(3):
        for end in (0, cells):
            side = np.zeros((len(i), 3), dtype=np.int64)
            side[:, axis], side[:, (axis + 1) % 3], side[:, (axis + 2) % 3] = end, i, j
            faces.append(len(i) * len(points) + (square if end else square[:, ::-1]))
            points.append(side)
    places, index = np.unique(np.vstack(points), axis=0, return_inverse=True)
    F = index.reshape(-1)[np.vstack(faces)]
    V = places / cells
    # One half is lower: the top's middle line becomes a wall of one row of faces.
    low = (V[:, 0] > 0.5) & (V[:, 2] > 0.5)
    V[low, 2] = 0.5 + (V[low, 2] - 0.5) * 0.2
    return _noisy(V, F, noise, seed), F


def terrain(noise: float = 0.2, *, seed: int = 0) -> Mesh:
    """Return hills of 100 x 100 points, one unit apart: open, 10,000 vertices.

    Parameters are those of `scan`.
    """
    x, y, F = _squares(99)
    z = 8 * np.sin(x / 17) * np.cos(y / 13) + 3 * np.sin(x / 7 + 1) * np.sin(y / 9)
    return _noisy(np.column_stack([x, y, z]), F, noise, seed), F


def save(path: str | Path, vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> None:
    """Write a mesh as a binary PLY file; an existing file is replaced."""
    write_ply(Path(path), vertices, faces)


def _sphere(subdivisions: int) -> Mesh:
    """Return a unit sphere: an icosahedron, whose triangles are divided into four."""
    g = (1 + 5**0.5) / 2
    V = np.array(
        [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g],
         [0, -1, -g], [0, 1, -g], [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]
    )  # fmt: skip
    F = np.array(
        [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4],
         [11, 10, 2], [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8],
         [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]]
    )  # fmt: skip
    for _ in range(subdivisions):
        sides = np.sort(np.vstack([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
        edges, index = np.unique(sides, axis=0, return_inverse=True)
        ab, bc, ca = len(V) + index.reshape(3, -1)
        V = np.vstack([V, V[edges].mean(axis=1)])
        a, b, c = F.T
        corners = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        F = np.vstack([np.column_stack(one) for one in corners])
    return V / np.linalg.norm(V, axis=1, keepdims=True), F


def _noisy(
    V: NDArray[np.float64], F: NDArray[np.int64], noise: float, seed: int
) -> NDArray[np.float64]:
    """Move vertices along their normals, by a number of mean edges at random."""
    edge = float(np.linalg.norm(V[F[:, 1]] - V[F[:, 0]], axis=1).mean())
    height = noise * edge * np.random.default_rng(seed).standard_normal(len(V))
    moved: NDArray[np.float64] = V + height[:, None] * vertex_normals(V, F)
    return moved


def _squares(cells: int) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return the rows and columns of the points of a grid, and two triangles for each cell."""
    k = np.arange(cells + 1)
    i, j = (one.ravel() for one in np.meshgrid(k, k, indexing="ij"))
    a = (k[:-1, None] * (cells + 1) + k[:-1]).ravel()
    b, c, d = a + cells + 1, a + cells + 2, a + 1
    return i, j, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
