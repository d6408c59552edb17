"""Spectral Denoise's equations on closed meshes, implemented independently with SciPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg
from numpy.typing import NDArray

Array = NDArray[np.float64]


def unit(N: Array) -> Array:
    return np.asarray(N / np.maximum(np.linalg.norm(N, axis=1, keepdims=True), 1e-300))


def mean_edge(V: Array, F: NDArray[Any]) -> float:
    return float(np.linalg.norm(V[F] - V[np.roll(F, 1, axis=1)], axis=2).mean())


def limited(X0: Array, X: Array, farthest: float) -> Array:
    away = np.linalg.norm(X - X0, axis=1, keepdims=True)
    return np.asarray(X0 + np.minimum(1, farthest / np.maximum(away, 1e-300)) * (X - X0))


def upper_median(values: Array) -> float:
    return float(np.sort(values)[len(values) // 2])


def trimmed(moduli: Array) -> float:
    """Return the deviation of moduli within three deviations."""
    deviation = upper_median(moduli) / 0.6745
    for _ in range(5):
        deviation = upper_median(moduli[moduli < 3 * deviation]) / 0.6722
    return deviation


def probes(X: Array) -> Array:
    """Return n x 5 random signs by position: SplitMix64 of the places in the bounding box."""

    def mixed(bits: NDArray[np.uint64]) -> NDArray[np.uint64]:
        bits = bits + np.uint64(0x9E3779B97F4A7C15)
        bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return np.asarray(bits ^ (bits >> np.uint64(31)))

    centred = X - 0.5 * (X.max(axis=0) + X.min(axis=0))
    centred -= 0.5 * (centred.max(axis=0) + centred.min(axis=0))
    places = centred * (2.0**26 / np.ptp(centred, axis=0).max())
    rounded = (np.sign(places) * np.floor(np.abs(places) + 0.5)).astype(np.int64).astype(np.uint64)
    bits = np.zeros(len(X), np.uint64)
    for c in range(3):
        bits = mixed(bits ^ rounded[:, c])
    draws = np.arange(63, 58, -1, dtype=np.uint64)
    return np.asarray(1.0 - 2.0 * (bits[:, None] >> draws & np.uint64(1)))


class Reference:
    """The parts of the filter on a closed, oriented manifold mesh."""

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

    # Measurement.

    def noise(self, X: Array) -> tuple[float, float]:
        """Height and size of the noise, by the octaves of diffusion."""
        N = self.vertex_normals(X, 3)
        along, white = [], []
        Y, w = X, probes(X)
        for k in range(7):
            times = 2**k - (2 ** (k - 1) if k else 0)
            Z, z = self.diffused(Y, times), self.diffused(w, times)
            along.append(np.abs(((Y - Z) * N).sum(axis=1)))
            white.append(np.sqrt(((w - z) ** 2).mean()))
            Y, w = Z, z
        energy = self.diffused(along[3] ** 2, 16)
        quiet = energy <= np.sort(energy)[self.n // 2]
        heights = [trimmed(m[quiet]) / w for m, w in zip(along, white, strict=True)]
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
        both = np.hstack([X, probes(X)[:, :1]])
        for _ in range(2):
            both = both - self.P @ both
        moduli = np.abs((both[:, :3] * N).sum(axis=1))
        lowest = min(n[0], trimmed(moduli) / np.sqrt((both[:, 3] ** 2).mean()))
        return (lowest, 1.0) if size < 1.22 else (1.3 * np.sqrt(energies.sum() / (g @ g)), size)

    # Normals and vertices.

    def filtered_normals(
        self,
        X: Array,
        time: float,
        scale: float,
        height: float,
        blurs: int,
        twice: bool,
        guide: Array | None = None,
    ) -> Array:
        N = self.area_normals(X)
        area = np.linalg.norm(N, axis=1)
        q = N
        for _ in range(blurs):
            q = self.average @ q
        q = unit(q) if guide is None else guide
        local = np.sqrt(area / area.mean())
        for _ in range(6):
            local = local / 4 + self.neighbours @ local / 4
        (a, b), (i, j) = self.pairs.T, self.ends.T
        e = np.linalg.norm(X[i] - X[j], axis=1)
        shortness = np.maximum(0, 1 / (local[a] * local[b]) - 2)
        squared = scale**2 + (0.5 * height) ** 2 * shortness
        distance = ((q[a] - q[b]) ** 2).sum(axis=1)
        w = np.exp(-distance / (2 * squared))
        if guide is not None:
            w += 30 / (1 + distance / 0.02**2)
        w *= e / e.mean()
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

    def finished(self, X0: Array, X: Array, N: Array, height: float) -> Array:
        X = limited(X0, self.unfolded(X, N, 5 * height), 6 * height)
        for _ in range(4):  # Newton's method for the volume, along the normals of the vertices
            G = self.incidence @ self.area_normals(X)
            size = np.linalg.norm(G, axis=1).sum() / 6
            X = X + (self.volume(X0) - self.volume(X)) / size * unit(G)
        return X

    # Removal of each kind of noise, of a given height.

    def rounds(self, X0: Array, height: float, most_rounds: int) -> tuple[Array, Array, int]:
        edge = mean_edge(X0, self.F)
        weaker = 1 + (0.13 * edge / height) ** 3
        X, number = X0, 0
        while number < most_rounds:
            time, sweeps, scale = (4, 16, 0.25) if number < 6 else (8, 32, 0.22)
            N = self.filtered_normals(X, time / weaker, scale, height / edge, 2, True)
            Y = limited(X0, self.followed(X0, N, sweeps), 6 * height)
            y = ((Y - X0) * self.vertex_normals(Y, 1)).sum(axis=1)
            degrees = np.diff(self.P.indptr)
            smooth = self.diffused(y, 1).std() / y.std() / np.sqrt((1 + 1 / degrees).mean() / 4)
            if number == 0:
                most = 0.957 * max(1, smooth / 0.76) ** 0.75
            elif smooth > most:
                break
            X, last, number = Y, N, number + 1
            if upper_median(np.linalg.norm(X - X0, axis=1)) / 0.6745 > 1.03 * height:
                break
        return X, last, number

    def flattened(self, X0: Array, N: Array, height: float) -> tuple[Array, Array]:
        N = self.filtered_normals(X0, 6, 0.22, 0, 0, True, N)
        return limited(X0, self.followed(X0, N, 60), 6 * height), N

    def without_white_noise(self, X0: Array, height: float) -> Array:
        X, N, number = self.rounds(X0, height, 10)
        if number > 6:  # by noise splitting, with noise drawn in another way than the plugin's
            D, noise = (
                self.vertex_normals(X, 1),
                height * np.random.default_rng(1).normal(size=(self.n, 1)),
            )
            training, judging = X0 + 0.7 * noise * D, X0 - noise * D / 0.7
            one, M, _ = self.rounds(training, np.sqrt(1.49) * height, 6)
            other, _ = self.flattened(training, M, np.sqrt(1.49) * height)
            before, after = (((Y - judging) * D).sum(axis=1) for Y in (one, other))
            deviation = 2 * height * np.sqrt(1 + 1 / 0.49) * np.linalg.norm(before - after)
            if before @ before - after @ after > deviation:
                X, N = self.flattened(X0, N, height)
        return self.finished(X0, X, N, height)

    def without_correlated_noise(self, X0: Array, height: float, size: float) -> Array:
        edge = mean_edge(X0, self.F)
        length = min(0.8 * size / edge, 4)
        X = X0
        for number in range(6):
            N = self.filtered_normals(X, 1.5 * length**2, 0.22, 0, int(2 * length**2), False)
            Y = self.followed(X0, N, round(12 * length))
            removed = upper_median(np.linalg.norm(Y - X0, axis=1)) / 0.6745
            X = limited(X0, Y, 6 * height)
            if number and removed >= 0.8 * height:
                break
        return self.finished(X0, X, N, height)
