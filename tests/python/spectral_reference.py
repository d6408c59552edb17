"""An independent implementation of the filter, with all eigenvectors, in NumPy and SciPy.

Written from the mathematics (Kovnatsky et al. 2012; Vallet and Levy 2008), not from the plugin's
source, so that an error has to be made twice to pass. The intrinsic Delaunay Laplacian is that of
the package robust_laplacian, by its authors. Slow and plain on purpose: n up to about
1,500 vertices, but for `artefacts`, which takes any mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import robust_laplacian
import scipy.integrate
import scipy.linalg
import scipy.sparse
import scipy.sparse.csgraph
import scipy.sparse.linalg
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Gain = Callable[[Array], Array]


@dataclass(frozen=True)
class Spectrum:
    """All harmonics of one connected component, on its vertices `of`.

    lam: ascending, the first exactly 0. Phi: columns with Phi^T diag(d) Phi = 1.
    """

    of: Indices
    lam: Array
    Phi: Array
    d: Array


def cotangent_matrix(V: Array, F: Indices) -> scipy.sparse.csr_array:
    """W of W phi = lambda D phi (Eq. 4), n x n, positive semidefinite."""
    n = len(V)
    rows, columns, weights = [], [], []
    for corner in range(3):
        i, j, k = F[:, (corner + 1) % 3], F[:, (corner + 2) % 3], F[:, corner]
        a, b = V[i] - V[k], V[j] - V[k]
        half_cot = 0.5 * np.sum(a * b, axis=1) / np.linalg.norm(np.cross(a, b), axis=1)
        rows += [i, j, i, j]
        columns += [j, i, i, j]
        weights += [-half_cot, -half_cot, half_cot, half_cot]
    entries = (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns)))
    return scipy.sparse.coo_array(entries, shape=(n, n)).tocsr()


def triangle_areas(V: Array, F: Indices) -> Array:
    """Areas of the m triangles."""
    a, b, c = V[F[:, 0]], V[F[:, 1]], V[F[:, 2]]
    areas: Array = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return areas


def lumped_areas(V: Array, F: Indices) -> Array:
    """Diagonal of D: a third of the area of the triangles at each of the n vertices."""
    return np.bincount(F.ravel(), weights=np.repeat(triangle_areas(V, F) / 3, 3), minlength=len(V))


def components(n: int, F: Indices) -> list[Indices]:
    """Vertices of every connected component that has triangles."""
    edges = np.concatenate([F[:, [0, 1]], F[:, [1, 2]]])
    graph = scipy.sparse.coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(n, n))
    count, label = scipy.sparse.csgraph.connected_components(graph, directed=False)
    groups = [np.flatnonzero(label == number) for number in range(count)]
    return [group for group in groups if len(group) > 1]


def spectra(W: scipy.sparse.csr_array, d: Array, parts: list[Indices]) -> list[Spectrum]:
    """Solve W phi = lambda D phi on every component, for all eigenpairs."""
    result = []
    for of in parts:
        root = np.sqrt(d[of])
        S = W[of][:, of].toarray() / np.outer(root, root)
        lam, Q = scipy.linalg.eigh((S + S.T) / 2, driver="evd")
        lam = np.maximum(lam, 0)
        lam[0] = 0
        result.append(Spectrum(of, lam, Q / root[:, None], d[of]))
    return result


def low_pass(x: Array, response: str, order: int) -> Array:
    """Prototype of the low-pass, x = omega / omega_c; 1/sqrt(2) at x = 1 when smooth."""
    if response == "gaussian":
        return np.exp2(-(x**2) / 2)
    if response == "butterworth":
        return 1 / np.sqrt(1 + x ** (2 * order))
    return np.where(x <= 1, 1.0, 0.0)


def band_pass(x: Array, response: str, order: int, band_width: float) -> Array:
    """Prototype of the band-pass; `band_width` in octaves between its -3 dB points."""
    octaves = np.log2(x)
    if response == "gaussian":
        return np.exp2(-((2 * octaves / band_width) ** 2) / 2)
    if response == "butterworth":
        q = 2 ** (band_width / 2) - 2 ** (-band_width / 2)
        return 1 / np.sqrt(1 + ((x - 1 / x) / q) ** (2 * order))
    return np.where(np.abs(octaves) <= band_width / 2, 1.0, 0.0)


def transfer_function(
    filter_type: str,
    feature_size: float,
    response: str = "gaussian",
    order: int = 2,
    band_width: float = 1.0,
    pass_gain: float = 1.0,
    stop_gain: float = 0.0,
) -> Gain:
    """F(omega) for omega > 0 (the constant modes are the caller's), feature_size a length."""
    omega_c = 2 * np.pi / feature_size

    def F(omega: Array) -> Array:
        x = omega / omega_c
        if filter_type == "low-pass":
            B = low_pass(x, response, order)
        elif filter_type == "high-pass":
            B = low_pass(1 / x, response, order)
        else:
            B = band_pass(x, response, order, band_width)
            if filter_type == "band-stop":
                B = 1 - B
        return stop_gain + (pass_gain - stop_gain) * B

    return F


def apply_gain(X: Array, spectrum: list[Spectrum], gain: Gain) -> Array:
    """Y = Phi F Phi^T D X with all eigenvectors; the constant modes keep gain 1."""
    Y = X.copy()
    for part in spectrum:
        g = np.ones_like(part.lam)
        g[1:] = gain(np.sqrt(part.lam[1:]))
        Y[part.of] = part.Phi @ (g[:, None] * (part.Phi.T @ (part.d[:, None] * X[part.of])))
    return Y


def matrices(V: Array, F: Indices, laplacian: str) -> tuple[scipy.sparse.csr_array, Array]:
    """W of any kind of Laplacian, and the diagonal of D."""
    d = masses(V, F, laplacian)
    if laplacian == "cotangent":
        return cotangent_matrix(V, F), d
    if laplacian == "uniform":
        return uniform_matrix(len(V), F), d
    W, _ = robust_laplacian.mesh_laplacian(V, F)
    return scipy.sparse.csr_array(W), d


def uniform_matrix(n: int, F: Indices) -> scipy.sparse.csr_array:
    """W of a mesh of equilateral triangles, whatever their shapes are."""
    sides = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    ends = (sides[:, 0], sides[:, 1])
    once = scipy.sparse.coo_array((np.full(len(sides), 0.5 / np.sqrt(3)), ends), shape=(n, n))
    adjacency = (once + once.T).tocsr()
    return scipy.sparse.csr_array(scipy.sparse.csgraph.laplacian(adjacency))


def masses(V: Array, F: Indices, laplacian: str) -> Array:
    """Diagonal of D: vertex areas, or for the uniform Laplacian their mean."""
    d = lumped_areas(V, F)
    return np.full_like(d, d[d > 0].mean()) if laplacian == "uniform" else d


def full_filter(
    V: Array,
    F: Indices,
    gain: Gain,
    steps: int,
    basis_update: str,
    laplacian: str = "cotangent",
    conformal_share: float = 0.0,
) -> Array:
    """K steps of F^(1/K) (Eq. 11) with all eigenvectors; a share of W may stay the input's."""
    parts = components(len(V), F)
    W, d = matrices(V, F, laplacian)
    spectrum = spectra(W, d, parts)
    X = V.copy()
    for step in range(steps):
        if step > 0 and basis_update == "full":
            now, d = matrices(X, F, laplacian)
            spectrum = spectra((1 - conformal_share) * now + conformal_share * W, d, parts)
        if step > 0 and basis_update == "conformal":
            d = masses(X, F, laplacian)  # Kazhdan, Solomon and Ben-Chen 2012
            spectrum = spectra(W, d, parts)
        X = apply_gain(X, spectrum, lambda omega: gain(omega) ** (1 / steps))
    return X


def truncated_filter(
    V: Array,
    F: Indices,
    gain: Gain,
    steps: int,
    basis_update: str,
    basis_size: int,
    reinject_residual: bool,
) -> tuple[Array, list[int]]:
    """K steps with the `basis_size` lowest eigenpairs of a connected mesh (Eqs. 6 to 10).

    The rest of X gets F_h^(1/K), F_h the mean of F over [omega_k, omega_max], or is dropped.
    Returns the coordinates and the sizes of the bases of all steps.
    """
    (part,) = components(len(V), F)
    W, d = cotangent_matrix(V, F), lumped_areas(V, F)
    (spectrum,) = spectra(W, d, [part])
    sizes = []
    X = V.copy()
    for step in range(steps):
        if step > 0 and basis_update != "none":
            W = cotangent_matrix(X, F) if basis_update == "full" else W
            d = lumped_areas(X, F)
            (spectrum,) = spectra(W, d, [part])
        k = cut_outside_clusters(spectrum.lam, basis_size)
        sizes.append(k)
        omega = np.sqrt(spectrum.lam)
        g = np.ones(k)
        g[1:] = gain(omega[1:k]) ** (1 / steps)
        Phi = spectrum.Phi[:, :k]
        C = Phi.T @ (d[:, None] * X)
        F_h = mean_gain(gain, omega[k - 1], omega[-1]) if reinject_residual else 0.0
        X = Phi @ (g[:, None] * C) + F_h ** (1 / steps) * (X - Phi @ C)
    return X, sizes


def boundary_vertices(F: Indices) -> Indices:
    """End points of the edges of exactly one triangle, ascending."""
    edges = np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    return np.unique(unique[count == 1])


def fixed_spectrum(W: scipy.sparse.csr_array, d: Array, interior: Indices) -> Spectrum:
    """Solve W_II phi = lambda D_II phi, phi = 0 elsewhere, for all eigenpairs."""
    root = np.sqrt(d[interior])
    S = W[interior][:, interior].toarray() / np.outer(root, root)
    lam, Q = scipy.linalg.eigh((S + S.T) / 2, driver="evd")
    return Spectrum(interior, lam, Q / root[:, None], d[interior])


def fixed_filter(
    V: Array,
    F: Indices,
    gain: Gain,
    steps: int,
    basis_update: str,
    laplacian: str = "cotangent",
    basis_size: int | None = None,
) -> Array:
    """K steps with a fixed boundary, on a mesh each component of which has one.

    X = H + U with U = 0 on the boundary and H harmonic: Y = H + F^(1/K)(sqrt(A_II)) U, with all
    eigenvectors of the interior, or with the `basis_size` lowest and F_h for the rest (Eq. 9).
    """
    rim = boundary_vertices(F)
    interior = np.setdiff1d(np.arange(len(V)), rim)
    W, d = matrices(V, F, laplacian)
    spectrum = fixed_spectrum(W, d, interior)
    X = V.copy()
    for step in range(steps):
        if step > 0 and basis_update != "none":
            W = matrices(X, F, laplacian)[0] if basis_update == "full" else W
            d = lumped_areas(X, F)
            spectrum = fixed_spectrum(W, d, interior)
        rows = W[interior]
        H = scipy.linalg.solve(
            rows[:, interior].toarray(), -(rows[:, rim] @ X[rim]), assume_a="pos"
        )
        U = X[interior] - H
        omega = np.sqrt(spectrum.lam)
        k = len(omega)
        F_h = 0.0
        if basis_size is not None:
            k = cut_outside_clusters(spectrum.lam, basis_size)
            F_h = mean_gain(gain, omega[k - 1], omega[-1])
        Phi = spectrum.Phi[:, :k]
        C = Phi.T @ (spectrum.d[:, None] * U)
        g = gain(omega[:k]) ** (1 / steps)
        X[interior] = H + Phi @ (g[:, None] * C) + F_h ** (1 / steps) * (U - Phi @ C)
    return X


def cut_outside_clusters(lam: Array, asked: int) -> int:
    """Take more eigenpairs than asked while the next eigenvalue is nearly equal to the last one.

    Nearly equal, as the filter's documentation has it: nearer than a tenth of the mean spacing
    lambda_k / k. Every step of a filter may thus have a basis of another size.
    """
    k = asked
    while k < len(lam) and lam[k] - lam[k - 1] <= 0.1 * lam[asked - 1] / asked:
        k += 1
    return k


def mean_gain(gain: Gain, low: float, high: float) -> float:
    """Average of F over the frequencies from `low` to `high`."""
    integral, _ = scipy.integrate.quad(
        lambda omega: float(gain(np.array([omega]))[0]), low, high, epsrel=1e-10, limit=200
    )
    return integral / (high - low)


def signed_volume(V: Array, F: Indices, centre: Array) -> float:
    """Volume that the triangles enclose, as the sum of signed tetrahedra over `centre`."""
    a, b, c = (V[F[:, corner]] - centre for corner in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)


def artefacts(V: Array, F: Indices, feature_size: float, D: Array | None = None) -> Array:
    """Length of X - g(A) X at every vertex, g(lambda) = 1 / (1 + (lambda / (4 lambda_c))^4).

    The part of a shape above twice the cutoff of a filter, in the shape's own spectrum. By partial
    fractions, with two factorizations and no eigenvector: with x = lambda / (4 lambda_c) and the
    roots z of z^4 = -1, 1 / (1 + x^4) is the sum of -(z / 4) / (x - z). Roots come in conjugate
    pairs, so twice the real part of one of each is enough. 0 at vertices without triangles.

    D: the masses; by default those of the intrinsic Delaunay triangulation, robust_laplacian's. The
    plugin's are areas of the mesh's own triangles, which slivers make a hundred times as small.
    """
    used, corners = np.unique(F, return_inverse=True)
    X = V[used] - V[used].mean(axis=0)
    W, M = robust_laplacian.mesh_laplacian(X, corners.reshape(-1, 3))
    if D is not None:
        M = scipy.sparse.diags_array(D[used])
    lam_c = (2 * np.pi / feature_size) ** 2
    smooth = np.zeros_like(X)
    for z in np.exp(1j * np.pi / 4 * np.array([1, 3])):
        factor = scipy.sparse.linalg.splu(
            scipy.sparse.csc_array(W / (4 * lam_c) - z * M),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.01,
            options={"SymmetricMode": True},
        )
        smooth += 2 * np.real(-z / 4 * factor.solve((M @ X).astype(complex)))
    length = np.zeros(len(V))
    length[used] = np.linalg.norm(X - smooth, axis=1)
    return length
