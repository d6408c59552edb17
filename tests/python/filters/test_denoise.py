"""Spectral Denoise does what its equations say, as an implementation of its own with SciPy does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, get_args, get_type_hints

import numpy as np
import pymeshlab
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg
from helpers import assert_same, decorated, length, lower_part, mesh_set_of, refusal, snapshot
from meshlab_spectral import DenoiseOptions, OptionError, denoise_mesh
from numpy.typing import NDArray

DENOISE = "apply_coord_spectral_denoise"

Array = NDArray[np.float64]
Decimated = Callable[..., tuple[NDArray[Any], NDArray[Any]]]


def unit(N: Array) -> Array:
    return np.asarray(N / np.maximum(np.linalg.norm(N, axis=1, keepdims=True), 1e-300))


def mean_edge(V: Array, F: NDArray[Any]) -> float:
    return float(np.linalg.norm(V[F] - V[np.roll(F, 1, axis=1)], axis=2).mean())


def noisy(V: Array, F: NDArray[Any], height: float, seed: int = 1) -> Array:
    """Noise of `height` mean edges along every axis."""
    noise = np.random.default_rng(seed).standard_normal(V.shape)
    return np.asarray(V + height * mean_edge(V, F) * noise)


def limited(X0: Array, X: Array, farthest: float) -> Array:
    away = np.linalg.norm(X - X0, axis=1, keepdims=True)
    return np.asarray(X0 + np.minimum(1, farthest / np.maximum(away, 1e-300)) * (X - X0))


def upper_median(values: Array) -> float:
    return float(np.sort(values)[len(values) // 2])


class Reference:
    """A closed, oriented manifold mesh, and the parts of the filter on it."""

    def __init__(self, F: NDArray[Any], n: int) -> None:
        sides = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
        face = np.tile(np.arange(len(F)), 3)
        order = np.lexsort(np.sort(sides, axis=1).T)
        self.ends = np.sort(sides, axis=1)[order][::2]
        self.pairs = face[order].reshape(-1, 2)
        self.F, self.n = F, n
        a, b = self.pairs.T
        between = sp.coo_array((np.ones(len(a)), (a, b)), shape=(len(F), len(F)))
        self.average = (between + between.T + sp.eye_array(len(F))).tocsr()
        self.incidence = sp.csr_array((np.ones(F.size), (F.ravel(), np.repeat(face[: len(F)], 3))))

    def area_normals(self, X: Array) -> Array:
        a, b, c = (X[self.F[:, k]] for k in range(3))
        return np.cross(b - a, c - a)

    def noise(self, X: Array) -> tuple[float, float]:
        """Standard deviation of the noise, and the mean edge without it."""
        N = self.area_normals(X)
        for _ in range(3):
            N = self.average @ N
        N = unit(self.incidence @ N)
        i, j = self.ends.T
        A = sp.coo_array((np.ones(len(i)), (i, j)), shape=(self.n, self.n))
        A = (A + A.T).tocsr()
        L = (sp.eye_array(self.n) - sp.diags_array(1 / A.sum(axis=1)) @ A).tocsr()
        deviations = []
        for S in (L, (L @ L).tocsr()):
            moduli = np.abs(((S @ X) * N).sum(axis=1)) / np.sqrt((S * S).sum(axis=1))
            deviation = upper_median(moduli) / 0.6745
            for _ in range(5):
                deviation = upper_median(moduli[moduli < 3 * deviation]) / 0.6722
            deviations.append(deviation)
        coarse, fine = deviations[0], min(deviations)
        height = np.sqrt(max(0.0, (fine**2 - 0.17 * coarse**2) / 0.83))
        edge = mean_edge(X, self.F)
        return float(height), float(np.sqrt(max(edge**2 - 2 * height**2, edge**2 / 4)))

    def filtered_normals(self, X: Array, time: float, scale: float) -> Array:
        N = self.area_normals(X)
        area = np.linalg.norm(N, axis=1)
        q = unit(self.average @ (self.average @ N))
        (a, b), (i, j) = self.pairs.T, self.ends.T
        e = np.linalg.norm(X[i] - X[j], axis=1)
        w = e / e.mean() * np.exp(-((q[a] - q[b]) ** 2).sum(axis=1) / (2 * scale**2))
        W = sp.coo_array((w, (a, b)), shape=(len(N), len(N)))
        M = sp.diags_array(np.sqrt(np.maximum(area / area.mean(), 0.05)))
        L = sp.csgraph.laplacian((W + W.T).tocsr())
        return unit(scipy.sparse.linalg.spsolve((M + time * L).tocsc(), M @ unit(N)))

    def followed(self, X: Array, N: Array, sweeps: int) -> Array:
        faces = self.incidence.sum(axis=1)
        for _ in range(sweeps):
            pull = np.zeros_like(X)
            for k in range(3):
                away = (N * (X[self.F].mean(axis=1) - X[self.F[:, k]])).sum(axis=1)
                np.add.at(pull, self.F[:, k], N * away[:, None])
            X = X + pull / faces[:, None]
        return X

    def unfolded(self, X: Array, N: Array, farthest: float) -> Array:
        faces = self.incidence.sum(axis=1)
        normal = unit(self.incidence @ N)
        for _ in range(10):
            folded = (self.area_normals(X) * N).sum(axis=1) < 0
            if not folded.any():
                break
            corners = np.unique(self.F[folded])
            way = (self.incidence @ X[self.F].sum(axis=1) / faces[:, None] - 3 * X) / 2
            way -= (way * normal).sum(axis=1, keepdims=True) * normal
            corners = corners[np.linalg.norm(way[corners], axis=1) <= farthest]
            X = X.copy()
            X[corners] += way[corners]
        return X

    def volume(self, X: Array) -> float:
        a, b, c = (X[self.F[:, k]] for k in range(3))
        return float((np.cross(a, b) * c).sum() / 6)

    def denoised(self, X0: Array) -> Array:
        height, edge = self.noise(X0)
        time = 1.5 / (1 + (0.13 * edge / height) ** 3)
        farthest = max(3 * height, 0.3 * edge)
        X = X0
        for _ in range(12):
            N = self.filtered_normals(X, time, 0.22)
            X = limited(X0, self.followed(X0, N, 12), farthest)
            if upper_median(np.linalg.norm(X - X0, axis=1)) / 0.6745 >= 0.96 * height:
                break
        X = limited(X0, self.unfolded(X, N, 2.5 * height), farthest)
        for _ in range(4):  # Newton's method for the volume, along the normals of the vertices
            G = self.incidence @ self.area_normals(X)
            size = np.linalg.norm(G, axis=1).sum() / 6
            X = X + (self.volume(X0) - self.volume(X)) / size * unit(G)
        return X


@pytest.mark.parametrize("height", [0.05, 0.15, 0.3])
def test_the_equations_agree(
    height: float, decimated: Decimated, record_property: Callable[..., None]
) -> None:
    V, F = decimated("cow.obj", 2000)
    X = noisy(V, F, height)
    reference = Reference(F, len(V))
    Y, report = denoise_mesh(X, F)
    expected_height, expected_edge = reference.noise(X)
    assert report["estimated_noise_height"] == pytest.approx(expected_height, rel=1e-9)
    assert report["mean_edge"] == pytest.approx(expected_edge, rel=1e-9)
    expected = reference.denoised(X)
    error = np.linalg.norm(Y - expected, axis=1).max() / mean_edge(V, F)
    record_property("largest_distance_in_edges", error)
    assert np.linalg.norm(Y - X, axis=1).max() > 0.1 * height * mean_edge(V, F)
    assert error < 1e-3


@pytest.mark.parametrize("name", ["cow.obj", "bunny.obj"])
@pytest.mark.parametrize("height", [0.1, 0.2])
def test_noise_goes_and_the_shape_stays(name: str, height: float, decimated: Decimated) -> None:
    V, F = decimated(name, 6000)
    N = unit(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]))

    def angles(X: Array) -> Array:
        M = unit(np.cross(X[F[:, 1]] - X[F[:, 0]], X[F[:, 2]] - X[F[:, 0]]))
        return np.asarray(np.arccos(np.clip((M * N).sum(axis=1), -1, 1)))

    X = noisy(V, F, height)
    Y, report = denoise_mesh(X, F)
    assert angles(Y).mean() < 0.75 * angles(X).mean()
    assert np.linalg.norm(Y - V, axis=1).mean() < np.linalg.norm(X - V, axis=1).mean()
    expected = height * mean_edge(V, F)
    assert report["estimated_noise_height"] == pytest.approx(expected, rel=0.3)
    assert report["warnings"] == []


def test_a_rim_stays_to_the_bit(decimated: Decimated) -> None:
    V, F = lower_part(*decimated("bunny.obj", 2400))
    X = noisy(V, F, 0.2)
    Y, report = denoise_mesh(X, F)
    unmoved = (Y == X).all(axis=1)
    assert 0 < report["fixed_vertices"] <= unmoved.sum() < 0.5 * len(V)
    free, _ = denoise_mesh(X, F, boundary="free")
    assert (free == X).all(axis=1).sum() < unmoved.sum()


def test_every_other_attribute_survives(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 2000)
    mesh_set = decorated(noisy(V, F, 0.2), F)
    before = snapshot(mesh_set.current_mesh())
    report = mesh_set.apply_filter(DENOISE)
    assert report["max_displacement"] > 0
    after = snapshot(mesh_set.current_mesh())
    positions_and_normals = ("vertex_matrix", "vertex_normal_matrix", "face_normal_matrix")
    for name in positions_and_normals:
        before.pop(name, None)
        after.pop(name, None)
    assert_same(before, after)


def test_a_given_height_and_strength_are_taken(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 2000)
    X = noisy(V, F, 0.2)
    edge = mean_edge(X, F)
    Y, report = denoise_mesh(X, F, noise_height="0.1e", strength=0.5)
    assert report["noise_height"] == pytest.approx(0.05 * edge, rel=1e-6)
    Z, report = denoise_mesh(X, F, noise_height=0.1 * edge, strength=0.5)
    np.testing.assert_array_equal(Y, Z)
    same, report = denoise_mesh(X, F, strength=0.0)
    assert report["rounds"] == 0
    np.testing.assert_array_equal(same, X)


def test_noise_above_half_an_edge_is_a_warning(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 2000)
    _, report = denoise_mesh(noisy(V, F, 2.0), F)
    assert any("higher than half an edge" in warning for warning in report["warnings"])


def test_names_order_and_defaults_are_those_of_the_plugin(decimated: Decimated) -> None:
    parameters = mesh_set_of(*decimated("cow.obj")).filter_parameter_values(DENOISE)
    expected = DenoiseOptions().as_dict()
    assert list(parameters) == list(expected)
    expected["noise_height"] = 0.0  # auto
    boundary = get_args(get_type_hints(DenoiseOptions)["boundary"])
    expected["boundary"] = boundary.index(expected["boundary"])
    assert parameters == expected


def test_bad_options_and_meshes_are_refused(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    assert "strength" in refusal(mesh_set_of(V, F), DENOISE, strength=-1.0)
    assert "point cloud" in refusal(mesh_set_of(V, np.empty((0, 3), int)), DENOISE)
    with pytest.raises(OptionError, match="strength"):
        denoise_mesh(V, F, strength=-1)
    with pytest.raises(OptionError, match="noise_height"):
        denoise_mesh(V, F, noise_height="-2e")
    given = length(1e-3)
    assert isinstance(given, pymeshlab.PureValue)
