"""The matrices of `laplacian` against closed forms and robust_laplacian."""

from __future__ import annotations

from typing import Any

import meshlab_spectral
import numpy as np
import pytest
import robust_laplacian
from helpers import lower_part
from meshlab_spectral import laplacian
from shapes import grid, quads


@pytest.mark.parametrize("name", ["bunny.obj", "cow.obj", "bone.ply"])
def test_the_default_is_that_of_robust_laplacian(name: str, decimated: Any) -> None:
    V, F = decimated(name)
    part = lower_part(V, F)
    tips = V[F[:20, 0]] + 0.1 * np.random.default_rng(3).standard_normal((20, 3)) * np.ptp(V)
    fins = np.column_stack([F[:20, :2], len(V) + np.arange(20)])  # edges of three triangles
    for mesh in ((V, F), part, (np.vstack([V, tips]), np.vstack([F, fins]))):
        expected, _ = robust_laplacian.mesh_laplacian(*mesh)
        assert abs(laplacian(*mesh)[0] - expected).max() < 1e-11 * abs(expected).max()


def test_lengths_are_mollified_by_the_mean_of_the_edges() -> None:
    """Not of the sides, among which those within a boundary count twice."""
    V = np.array([[x, y, 0.0] for x in range(6) for y in range(4)])
    F = quads(grid(6, 4))
    V += 0.3 * np.random.default_rng(0).normal(size=V.shape)
    V[5] = 0.5 * (V[0] + V[4]) + 1e-6  # a flat triangle
    expected, _ = robust_laplacian.mesh_laplacian(V, F)
    unmollified, _ = robust_laplacian.mesh_laplacian(V, F, mollify_factor=0.0)
    assert abs(unmollified - expected).max() > 1e-4
    assert abs(laplacian(V, F)[0] - expected).max() < 1e-11


@pytest.mark.parametrize("kind", ["intrinsic delaunay", "cotangent", "uniform"])
def test_constants_are_in_the_kernel_and_masses_sum_to_the_area(kind: Any, decimated: Any) -> None:
    V, F = decimated("bunny.obj")
    W, D = laplacian(V, F, kind=kind)
    sides = V[F[:, 1:]] - V[F[:, :1]]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2
    assert W.shape == (len(V), len(V))
    assert abs(W.sum(axis=1)).max() < 1e-10 * abs(W).max()
    assert (W != W.T).nnz == 0
    assert D.sum() == pytest.approx(area, rel=1e-9)


def test_cotangents_of_a_right_angled_square_are_those_of_its_sides() -> None:
    V = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    F = np.array([[0, 1, 2], [0, 2, 3]])
    W, D = laplacian(V, F, kind="cotangent")
    expected = np.array(
        [[1, -0.5, 0, -0.5], [-0.5, 1, -0.5, 0], [0, -0.5, 1, -0.5], [-0.5, 0, -0.5, 1]]
    )
    np.testing.assert_allclose(W.toarray(), expected, atol=1e-15)
    np.testing.assert_allclose(D, [1 / 3, 1 / 6, 1 / 3, 1 / 6])


def test_vertices_without_faces_and_copies_along_a_seam_have_empty_rows() -> None:
    V = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [9, 9, 9], [0, 0, 0], [1, 1, 0]])
    F = np.array([[0, 1, 2], [5, 6, 3]])
    W, D = laplacian(V, F)
    whole_W, whole_D = laplacian(V[:4], np.array([[0, 1, 2], [0, 2, 3]]))
    np.testing.assert_allclose(W.toarray()[:4, :4], whole_W.toarray(), atol=1e-12)
    np.testing.assert_allclose(D, [*whole_D, 0, 0, 0])
    assert W[4:].nnz == 0


def test_a_wrong_kind_and_a_wrong_mesh_are_told() -> None:
    V, F = np.eye(3), np.array([[0, 1, 2]])
    with pytest.raises(meshlab_spectral.OptionError, match="kind = flat: choose intrinsic"):
        laplacian(V, F, kind="flat")  # type: ignore[arg-type]
    with pytest.raises(meshlab_spectral.MeshError, match="no faces"):
        laplacian(V, F[:0])
