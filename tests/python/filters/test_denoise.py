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


def normals_of(V: Array, F: NDArray[Any]) -> Array:
    return unit(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]))


def angles(A: Array, B: Array, F: NDArray[Any]) -> Array:
    return np.asarray(np.arccos(np.clip((normals_of(A, F) * normals_of(B, F)).sum(1), -1, 1)))


def noisy(V: Array, F: NDArray[Any], height: float, seed: int = 1) -> Array:
    """Noise of `height` mean edges along every axis."""
    noise = np.random.default_rng(seed).standard_normal(V.shape)
    return np.asarray(V + height * mean_edge(V, F) * noise)


def cube(cells: int) -> tuple[Array, NDArray[Any]]:
    """A closed cube whose sides are grids of squares, each of two triangles."""
    points: dict[tuple[int, ...], int] = {}
    faces = []
    for axis in range(3):
        for side in (0, cells):
            for i in range(cells):
                for j in range(cells):
                    corners = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        corner = [0, 0, 0]
                        corner[axis], corner[axis - 2], corner[axis - 1] = side, a, b
                        corners.append(points.setdefault(tuple(corner), len(points)))
                    turned = corners if side else corners[::-1]
                    faces += [turned[:3], [turned[0], *turned[2:]]]
    return np.array(list(points), float), np.array(faces)


def limited(X0: Array, X: Array, farthest: float) -> Array:
    away = np.linalg.norm(X - X0, axis=1, keepdims=True)
    return np.asarray(X0 + np.minimum(1, farthest / np.maximum(away, 1e-300)) * (X - X0))


def upper_median(values: Array) -> float:
    return float(np.sort(values)[len(values) // 2])


def white_noise(count: int) -> Array:
    """The plugin's, by Box and Muller from a Mersenne twister."""
    twister = np.random.MT19937()
    twister._legacy_seeding(1)
    raw = twister.random_raw(2 * ((count + 1) // 2)).reshape(-1, 2)
    u, v = ((raw + 0.5) / 2.0**32).T
    radius = np.sqrt(-2 * np.log(u))
    both = np.stack([radius * np.cos(2 * np.pi * v), radius * np.sin(2 * np.pi * v)], axis=1)
    return np.asarray(both.ravel()[:count])


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
        self.neighbours = (between + between.T).tocsr()
        self.average = (self.neighbours + sp.eye_array(len(F))).tocsr()
        self.incidence = sp.csr_array((np.ones(F.size), (F.ravel(), np.repeat(face[: len(F)], 3))))
        i, j = self.ends.T
        A = sp.coo_array((np.ones(len(i)), (i, j)), shape=(n, n))
        A = (A + A.T).tocsr()
        self.P = (sp.diags_array(1 / A.sum(axis=1)) @ A).tocsr()

    def area_normals(self, X: Array) -> Array:
        a, b, c = (X[self.F[:, k]] for k in range(3))
        return np.cross(b - a, c - a)

    def vertex_normals(self, X: Array, blurs: int) -> Array:
        N = self.area_normals(X)
        for _ in range(blurs):
            N = self.average @ N
        return unit(self.incidence @ N)

    def diffused(self, x: Array, times: int) -> Array:
        for _ in range(times):
            x = (x + self.P @ x) / 2
        return x

    # Measuring.

    def noise(self, X: Array) -> tuple[float, float]:
        """Height and size of the noise, by the octaves of diffusion."""
        N = self.vertex_normals(X, 3)
        along, white = [], []
        Y, w = X, white_noise(self.n)
        for k in range(7):
            times = 2**k - (2 ** (k - 1) if k else 0)
            Z, z = self.diffused(Y, times), self.diffused(w, times)
            along.append(np.abs(((Y - Z) * N).sum(axis=1)))
            white.append((w - z).std())
            Y, w = Z, z
        energy = self.diffused(along[3] ** 2, 16)
        quiet = energy <= np.sort(energy)[self.n // 2]
        heights = []
        for moduli, scale in zip(along, white, strict=True):
            moduli = moduli[quiet]
            deviation = upper_median(moduli) / 0.6745
            for _ in range(5):
                deviation = upper_median(moduli[moduli < 3 * deviation]) / 0.6722
            heights.append(deviation / scale)
        a, g = np.array(heights), np.array(white)
        rise = np.clip((a[3:] / a[2:-1]).max(), 2.3, 3.0)
        shape = [min(a[j] / rise ** (j - k) for j in range(k, 7)) for k in range(7)]
        n = np.sqrt(np.maximum(a**2 - np.array(shape) ** 2, 0))
        energies = np.zeros(7)
        for k in range(7):
            if n[k] < 0.45 * a[k] or a[max(k, 1)] >= 2.03 * a[max(k, 1) - 1]:
                break
            energies[k] = (n[k] * g[k]) ** 2
        lengths = np.sqrt([0.5, 1.5, 3, 6, 12, 24, 48])
        mean = (energies @ lengths) / energies.sum()
        size = max(1.0, mean / ((g**2)[:5] @ lengths[:5] / (g**2)[:5].sum()))
        return (n[0], 1.0) if size < 1.22 else (1.3 * np.sqrt(energies.sum() / (g @ g)), size)

    # Normals and vertices.

    def filtered_normals(
        self, X: Array, time: float, scale: float, height: float, blurs: int, twice: bool
    ) -> Array:
        N = self.area_normals(X)
        area = np.linalg.norm(N, axis=1)
        q = N
        for _ in range(blurs):
            q = self.average @ q
        q = unit(q)
        local = np.sqrt(area / area.mean())
        for _ in range(6):
            local = local / 4 + self.neighbours @ local / 4
        (a, b), (i, j) = self.pairs.T, self.ends.T
        e = np.linalg.norm(X[i] - X[j], axis=1)
        shortness = np.maximum(0, 1 / (local[a] * local[b]) - 2)
        squared = scale**2 + (0.5 * height) ** 2 * shortness
        w = e / e.mean() * np.exp(-((q[a] - q[b]) ** 2).sum(axis=1) / (2 * squared))
        W = sp.coo_array((w, (a, b)), shape=(len(N), len(N)))
        M = sp.diags_array(np.sqrt(np.maximum(area / area.mean(), 0.05)))
        L = sp.csgraph.laplacian((W + W.T).tocsr())
        solve = scipy.sparse.linalg.splu((M + time * L).tocsc()).solve
        N = unit(N)
        filtered = solve(M @ N)
        if twice:
            filtered = filtered + solve(M @ (N - filtered))
        return unit(filtered)

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
        for _ in range(20):
            now = self.area_normals(X)
            folded = (now * N).sum(axis=1) < 0.5 * np.linalg.norm(now, axis=1)
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

    def finished(self, X0: Array, X: Array, N: Array, height: float, edge: float) -> Array:
        X = limited(X0, self.unfolded(X, N, 5 * height), max(6 * height, 0.3 * edge))
        for _ in range(4):  # Newton's method for the volume, along the normals of the vertices
            G = self.incidence @ self.area_normals(X)
            size = np.linalg.norm(G, axis=1).sum() / 6
            X = X + (self.volume(X0) - self.volume(X)) / size * unit(G)
        return X

    # Kinds of noise, of a given height.

    def without_white_noise(self, X0: Array, height: float) -> Array:
        edge = mean_edge(X0, self.F)
        weaker = 1 + (0.13 * edge / height) ** 3
        X = X0
        for number in range(10):
            time, sweeps, scale = (4, 16, 0.25) if number < 6 else (8, 32, 0.22)
            N = self.filtered_normals(X, time / weaker, scale, height / edge, 2, True)
            Y = limited(X0, self.followed(X0, N, sweeps), max(3 * height, 0.3 * edge))
            y = ((Y - X0) * self.vertex_normals(Y, 1)).sum(axis=1)
            degrees = np.diff(self.P.indptr)
            smooth = self.diffused(y, 1).std() / y.std() / np.sqrt((1 + 1 / degrees).mean() / 4)
            if number == 0:
                most = 0.957 * max(1, smooth / 0.76) ** 0.75
            elif smooth > most:
                break
            X, last = Y, N
            if upper_median(np.linalg.norm(X - X0, axis=1)) / 0.6745 > 1.03 * height:
                break
        return self.finished(X0, X, last, height, edge)

    def without_correlated_noise(self, X0: Array, height: float, size: float) -> Array:
        edge = mean_edge(X0, self.F)
        length = min(0.8 * size / edge, 4)
        X = X0
        for number in range(6):
            N = self.filtered_normals(X, 1.5 * length**2, 0.22, 0, int(2 * length**2), False)
            Y = self.followed(X0, N, round(12 * length))
            X = limited(X0, Y, max(6 * height, 0.3 * edge))
            if number and upper_median(np.linalg.norm(Y - X0, axis=1)) / 0.6745 >= 0.8 * height:
                break
        return self.finished(X0, X, N, height, edge)


def assert_near(Y: Array, expected: Array, F: NDArray[Any], record: Callable[..., None]) -> None:
    """The plugin solves to a hundredth; a face that is folded or just not yet may differ."""
    d = np.linalg.norm(Y - expected, axis=1) / mean_edge(expected, F)
    middle, most = np.quantile(d, [0.5, 0.99])
    record("distance_in_edges", (middle, most))
    assert middle < 0.005
    assert most < 0.03


@pytest.mark.parametrize("height", [0.1, 0.2, 0.3])
def test_the_equations_agree_for_white_noise(
    height: float, record_property: Callable[..., None]
) -> None:
    V, F = cube(16)
    X = noisy(V, F, height)
    edge = mean_edge(X, F)
    Y, report = denoise_mesh(X, F)
    found, size = Reference(F, len(V)).noise(X)
    assert size == 1.0
    assert report["estimated_noise_height"] == pytest.approx(found, rel=1e-6)
    assert report["estimated_noise_size"] == pytest.approx(edge, rel=1e-9)
    assert "white noise" in report["summary"]
    expected = Reference(F, len(V)).without_white_noise(X, report["noise_height"])
    assert np.linalg.norm(Y - X, axis=1).max() > height * edge
    assert_near(Y, expected, F, record_property)


@pytest.mark.parametrize("size", [1.5, 2.5, 4.0])
def test_the_equations_agree_for_correlated_noise(
    size: float, decimated: Decimated, record_property: Callable[..., None]
) -> None:
    V, F = decimated("cow.obj", 2000)
    edge = mean_edge(V, F)
    X = noisy(V, F, 0.1)
    Y, report = denoise_mesh(X, F, noise_height=0.1 * edge, noise_size=size * edge)
    assert report["noise_size"] == pytest.approx(size * edge, rel=1e-6)
    expected = Reference(F, len(V)).without_correlated_noise(X, 0.1 * edge, size * edge)
    assert np.linalg.norm(Y - X, axis=1).max() > 0.1 * edge
    assert_near(Y, expected, F, record_property)


@pytest.mark.parametrize(
    ("name", "height", "left"),
    [
        ("bunny.obj", 0.1, 0.5),
        ("bunny.obj", 0.2, 0.4),
        ("cow.obj", 0.2, 0.6),
        ("cow.obj", 0.1, 0.8),
    ],
)
def test_noise_goes_and_the_shape_stays(
    name: str, height: float, left: float, decimated: Decimated
) -> None:
    # A cow of 5,804 faces is as rough as little noise, of which a part is left.
    V, F = decimated(name, 20000)
    X = noisy(V, F, height)
    Y, report = denoise_mesh(X, F)
    assert angles(Y, V, F).mean() < left * angles(X, V, F).mean()
    assert np.linalg.norm(Y - V, axis=1).mean() < np.linalg.norm(X - V, axis=1).mean()
    expected = height * mean_edge(V, F)
    if left < 0.7:
        assert report["estimated_noise_height"] == pytest.approx(expected, rel=0.1)
    assert report["warnings"] == []


@pytest.mark.parametrize("faces", [8000, 3000, 1000, 300])
@pytest.mark.parametrize("name", ["cow.obj", "bunny.obj"])
def test_a_coarse_mesh_without_noise_stays_to_the_bit(
    name: str, faces: int, decimated: Decimated
) -> None:
    V, F = decimated(name, faces)
    Y, report = denoise_mesh(V, F)
    np.testing.assert_array_equal(Y, V)
    assert report["max_displacement"] == 0
    assert report["warnings"] == [report["summary"]]
    assert "nothing changed" in report["summary"]
    # A little noise goes, or it stays; the shape does not become worse.
    X = noisy(V, F, 0.05)
    Y, _ = denoise_mesh(X, F)
    assert angles(Y, V, F).mean() <= angles(X, V, F).mean() * (1 + 1e-12)


def test_spikes_go_and_nothing_else_moves(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj", 20000)
    random = np.random.default_rng(2)
    spiked = random.random(len(V)) < 0.1
    normals = np.zeros_like(V)
    for k in range(3):
        np.add.at(normals, F[:, k], normals_of(V, F))
    heights = 0.7 * mean_edge(V, F) * random.choice([-1.0, 1.0], len(V)) * spiked
    X = V + unit(normals) * heights[:, None]
    Y, report = denoise_mesh(X, F)
    assert report["spikes"] == pytest.approx(spiked.sum(), rel=0.15)
    assert report["summary"].startswith("spikes at ")
    assert angles(Y, V, F).mean() < 0.3 * angles(X, V, F).mean()


def test_a_designed_part_is_left_alone_and_never_crumpled() -> None:
    turns = np.linspace(0, 2 * np.pi, 128, endpoint=False)
    ring = np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)
    up = np.array([[0.0, 0.0, 5.0]])
    V = np.concatenate([ring, ring + up, 0 * up, up])
    i, j = np.arange(128), (np.arange(128) + 1) % 128
    walls = [np.stack(t, axis=1) for t in ((i, j, i + 128), (j, j + 128, i + 128))]
    caps = [np.stack(t, axis=1) for t in ((j, i, 0 * i + 256), (i + 128, j + 128, 0 * i + 257))]
    F = np.concatenate([*walls, *caps])
    Y, report = denoise_mesh(V, F)
    np.testing.assert_array_equal(Y, V)
    assert "needle triangles" in report["summary"]
    Y, report = denoise_mesh(V, F, noise_height="0.2e")
    np.testing.assert_array_equal(Y, V)
    assert "folded" in report["warnings"][0]


def test_a_rim_follows_unless_it_is_fixed(decimated: Decimated) -> None:
    V, F = lower_part(*decimated("bunny.obj", 10000))
    X = noisy(V, F, 0.2)
    Y, report = denoise_mesh(X, F, boundary="fixed")
    unmoved = (Y == X).all(axis=1)
    assert 0 < report["fixed_vertices"] <= unmoved.sum() < 0.5 * len(V)
    free, report = denoise_mesh(X, F)
    assert report["fixed_vertices"] == 0
    assert (free == X).all(axis=1).sum() < unmoved.sum()


def test_only_the_selection_is_denoised(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj", 20000)
    X = noisy(V, F, 0.2)
    mesh_set = mesh_set_of(X, F)
    middle = (V[:, 1].min() + V[:, 1].max()) / 2
    mesh_set.compute_selection_by_condition_per_face(condselect=f"(y0 > {middle})")
    report = mesh_set.apply_filter(DENOISE)  # selected: as faces are
    Y = mesh_set.current_mesh().vertex_matrix()
    moved = (Y != X).any(axis=1)
    edge = mean_edge(V, F)
    assert moved[V[:, 1] > middle + edge].all()
    assert not moved[V[:, 1] < middle - 10 * edge].any()
    assert report["max_displacement"] > 0
    mesh_set = mesh_set_of(X, F)
    assert "nothing is selected" in refusal(mesh_set, DENOISE, selected=True)


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
    expected["noise_height"] = expected["noise_size"] = 0.0  # auto
    boundary = get_args(get_type_hints(DenoiseOptions)["boundary"])
    expected["boundary"] = boundary.index(expected["boundary"])
    assert parameters == expected


def test_bad_options_and_meshes_are_refused(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    assert "strength" in refusal(mesh_set_of(V, F), DENOISE, strength=-1.0)
    assert "point cloud" in refusal(mesh_set_of(V, np.empty((0, 3), int)), DENOISE)
    with pytest.raises(OptionError, match="strength"):
        denoise_mesh(V, F, strength=-1)
    for name in ("noise_height", "noise_size"):
        with pytest.raises(OptionError, match=name):
            denoise_mesh(V, F, **{name: "-2e"})
    given = length(1e-3)
    assert isinstance(given, pymeshlab.PureValue)
