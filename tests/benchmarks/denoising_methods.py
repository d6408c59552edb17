"""The methods of denoising that bench_denoise.py compares, as functions of arrays."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pymeshlab
import pyvista
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
Method = Callable[[Array, Any], Array]


def load(file: Path) -> tuple[Array, NDArray[Any]]:
    """Read vertices and faces."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(file))
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix().copy(), mesh.face_matrix().copy()


def unit(N: Array) -> Array:
    """Scale rows to length 1."""
    return np.asarray(N / np.maximum(np.linalg.norm(N, axis=1), 1e-300)[:, None])


def face_normals(V: Array, F: Any) -> Array:
    """Normals of the faces, of length twice the area."""
    return np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])


def meshlab(name: str, parameter: str | None = None) -> Method:
    """Wrap a smoothing filter of MeshLab or of the plugin as a method."""

    def method(V: Array, F: Any, value: Any = None) -> Array:
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(V, F))
        meshes.apply_filter(name, **({} if value is None else {parameter: value}))
        return meshes.current_mesh().vertex_matrix().copy()

    return method


def windowed_sinc(V: Array, F: Any, pass_band: float) -> Array:
    """VTK's windowed sinc smoothing."""
    surface = pyvista.PolyData.from_regular_faces(V, F)
    return np.asarray(surface.smooth_taubin(n_iter=50, pass_band=pass_band).points, float)


def bilateral_normals(V: Array, F: Any, chosen: tuple[float, int]) -> Array:
    """Bilateral normal filtering, local scheme (Zheng, Fu, Au, Tai 2011), from its equations."""
    sigma, iterations = chosen
    rows = np.repeat(np.arange(len(F)), 3)
    of_vertex = sp.csr_matrix((np.ones(F.size), (F.ravel(), rows)), (len(V), len(F)))
    pairs = (of_vertex.T @ of_vertex).tocoo()  # faces with a common vertex
    a, b = pairs.row[pairs.row != pairs.col], pairs.col[pairs.row != pairs.col]
    sides = face_normals(V, F)
    area = np.linalg.norm(sides, axis=1)
    N, centre = sides / np.maximum(area, 1e-300)[:, None], V[F].mean(1)
    distance = np.linalg.norm(centre[a] - centre[b], axis=1)
    near = area[b] * np.exp(-((distance / distance.mean()) ** 2) / 2)
    for _ in range(iterations):
        w = near * np.exp(-(((N[a] - N[b]) ** 2).sum(1)) / (2 * sigma**2))
        N = unit(sp.csr_matrix((w, (a, b)), (len(F), len(F))) @ N)
    X = V.copy()
    faces = np.asarray(of_vertex.sum(1)).ravel()
    for _ in range(20):
        centre = X[F].mean(1)
        move = np.zeros_like(X)
        for corner in range(3):
            reach = N * (N * (centre - X[F[:, corner]])).sum(1)[:, None]
            np.add.at(move, F[:, corner], reach)
        X += move / np.maximum(faces, 1)[:, None]
    return X


# Methods, and the parameters of which the best is taken.
METHODS: dict[str, tuple[Method, list[Any]]] = {
    "Laplacian": (
        meshlab("apply_coord_laplacian_smoothing", "stepsmoothnum"),
        [1, 2, 3, 5, 8],
    ),
    "Taubin": (
        meshlab("apply_coord_taubin_smoothing", "stepsmoothnum"),
        [3, 5, 8, 10, 15, 20, 30, 45],
    ),
}


MORE_METHODS: dict[str, tuple[Method, list[Any]]] = {
    "windowed sinc": (windowed_sinc, [0.02, 0.05, 0.1, 0.15, 0.2, 0.3]),
    "bilateral": (
        bilateral_normals,
        [(sigma, k) for sigma in (0.2, 0.3, 0.45, 0.6) for k in (1, 2, 5, 10, 20)],
    ),
}


def mesh_denoiser(V: Array, F: Any, _: None) -> Array:
    """The static and dynamic filter of meshsdfilter-tools."""
    with TemporaryDirectory() as folder:
        options, source, target = (Path(folder) / name for name in ("options", "in.obj", "out.obj"))
        options.write_text("Lambda 2\nEta 1.5\nMu 1.5\nNu 0.3\n", encoding="utf-8")
        with source.open("w") as file:
            np.savetxt(file, V, "v %.17g %.17g %.17g")
            np.savetxt(file, F + 1, "f %d %d %d")
        command = ["MeshDenoiser", options, source, target]
        subprocess.run(command, check=True, capture_output=True)
        return load(target)[0]


def meshlib_normals(V: Array, F: Any, _: None) -> Array:
    """MeshLib's denoising via normals."""
    from meshlib import mrmeshnumpy, mrmeshpy  # type: ignore[import-not-found]

    mesh = mrmeshnumpy.meshFromFacesVerts(np.asarray(F, np.int32), V)
    mrmeshpy.meshDenoiseViaNormals(mesh)
    return np.asarray(mrmeshnumpy.getNumpyVerts(mesh), float)


def rivals() -> dict[str, tuple[Method, list[Any]]]:
    """Those that are installed."""
    found: dict[str, tuple[Method, list[Any]]] = {}
    if shutil.which("MeshDenoiser"):
        found["MeshDenoiser"] = (mesh_denoiser, [None])
    if importlib.util.find_spec("meshlib"):
        found["MeshLib"] = (meshlib_normals, [None])
    return found


def same_vertices(method: Method, V: Array, F: Any, value: Any) -> Array:
    """The result of a method; V where it fails, or loses vertices."""
    try:
        X = method(V, F, value)
    except Exception:
        return V
    return X if X.shape == V.shape else V
