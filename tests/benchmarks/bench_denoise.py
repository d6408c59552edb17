"""Denoising against ground truth: noisy meshes whose clean originals are known.

usage: bench_denoise.py [--pairs FOLDER] [--pictures FOLDER] [NAME ...]

For every pair NAME_noisy.ply, NAME_clean.ply and every method: mean angle between the normals of
the faces in degrees / mean distance to the clean surface / mean distance of a vertex to its clean
place, both in mean edges. Methods with a parameter have two lines: at its default, and at its best,
the value with the least angle, chosen for each mesh by its clean original. Spectral Denoise has
nothing to choose. FOLDER defaults to ../shared/denoise beside the repository, the measure is
denoise_score.py beside FOLDER. --pictures writes a picture of four of the meshes side by side.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshlab_spectral
import numpy as np
import pymeshlab
import pyvista
import scipy.sparse as sp
from meshlab_spectral.figures.pictures import Panel, View, draw_side_by_side
from numpy.typing import NDArray

Array = NDArray[np.float64]
Method = Callable[[Array, Any], Array]

SHARED = Path(__file__).resolve().parents[3] / "shared"
# The constants of the method were chosen on these; it was then tried on the others.
CHOSEN_ON = ("igea_n3", "child_n3", "Fandisk0.3", "pierrot_i3")
GROUPS = {
    "organic": ("igea_n3", "Nicolo0.2", "julius_n2", "child_n3"),
    "CAD": ("trimstar_n3", "Fandisk0.3", "Block0.4"),
    "impulsive": ("pierrot_i3",),
}
PICTURED = ("trimstar_n3", "Fandisk0.3", "child_n3", "julius_n2")
_SCORE = re.compile(r"angle (\S+)  surface (\S+)  vertex (\S+)")


def meshlab(name: str, parameter: str | None = None) -> Method:
    """Return a smoothing of MeshLab's or of the plugin's as a method."""

    def method(V: Array, F: Any, value: Any = None) -> Array:
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(V, F))
        meshes.apply_filter(name, **({} if value is None else {parameter: value}))
        return meshes.current_mesh().vertex_matrix().copy()

    return method


def windowed_sinc(V: Array, F: Any, pass_band: float | None = None) -> Array:
    """VTK's windowed sinc smoothing."""
    surface = pyvista.PolyData.from_regular_faces(V, F)
    band = 0.1 if pass_band is None else pass_band
    return np.asarray(surface.smooth_taubin(n_iter=50, pass_band=band).points, float)


def bilateral_normals(V: Array, F: Any, sigma: float | None = None) -> Array:
    """Bilateral normal filtering, local scheme (Zheng, Fu, Au, Tai 2011), from its equations."""
    sigma = 0.35 if sigma is None else sigma
    rows = np.repeat(np.arange(len(F)), 3)
    of_vertex = sp.csr_matrix((np.ones(F.size), (F.ravel(), rows)), (len(V), len(F)))
    pairs = (of_vertex.T @ of_vertex).tocoo()  # faces with a common vertex
    a, b = pairs.row[pairs.row != pairs.col], pairs.col[pairs.row != pairs.col]
    sides = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    area = np.linalg.norm(sides, axis=1)
    N, centre = sides / np.maximum(area, 1e-300)[:, None], V[F].mean(1)
    distance = np.linalg.norm(centre[a] - centre[b], axis=1)
    near = area[b] * np.exp(-((distance / distance.mean()) ** 2) / 2)
    for _ in range(20):
        w = near * np.exp(-(((N[a] - N[b]) ** 2).sum(1)) / (2 * sigma**2))
        N = sp.csr_matrix((w, (a, b)), (len(F), len(F))) @ N
        N /= np.maximum(np.linalg.norm(N, axis=1), 1e-300)[:, None]
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


# Method, and the values that its best is taken from; None: its default.
METHODS: dict[str, tuple[Method, list[Any]]] = {
    "Spectral Denoise": (meshlab("apply_coord_spectral_denoise"), [None]),
    "MeshLab Laplacian": (
        meshlab("apply_coord_laplacian_smoothing", "stepsmoothnum"),
        [None, 1, 2, 5, 8],
    ),
    "MeshLab HC Laplacian": (meshlab("apply_coord_hc_laplacian_smoothing"), [None]),
    "MeshLab Taubin": (
        meshlab("apply_coord_taubin_smoothing", "stepsmoothnum"),
        [None, 3, 5, 8, 15, 20, 30, 45],
    ),
    "MeshLab two-step": (
        meshlab("apply_coord_two_steps_smoothing", "normalthr"),
        [None, 20.0, 40.0, 90.0],
    ),
    "VTK windowed sinc": (windowed_sinc, [None, 0.02, 0.05, 0.15, 0.2, 0.3]),
    "bilateral normals": (bilateral_normals, [None, 0.2, 0.25, 0.3, 0.45, 0.6]),
}


class Pair:
    """A noisy mesh and its original."""

    def __init__(self, folder: Path, name: str) -> None:
        self.clean = folder / f"{name}_clean.ply"
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(str(folder / f"{name}_noisy.ply"))
        mesh = meshes.current_mesh()
        self.V, self.F = mesh.vertex_matrix().copy(), mesh.face_matrix().copy()
        self._measure = folder.parent / "denoise_score.py"

    def scores(self, shapes: list[Array]) -> Array:
        """Angle, distance to the surface and of the vertices, a row for each shape."""
        with tempfile.TemporaryDirectory() as folder:
            files = [Path(folder, f"{number}.ply") for number in range(len(shapes))]
            for file, V in zip(files, shapes, strict=True):
                meshes = pymeshlab.MeshSet()
                meshes.add_mesh(pymeshlab.Mesh(V, self.F))
                meshes.save_current_mesh(str(file))
            command = [sys.executable, str(self._measure), str(self.clean), *map(str, files)]
            text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        return np.array([[float(x) for x in found] for found in _SCORE.findall(text)])


def told(scores: Array) -> str:
    """Format three scores."""
    return f"{scores[0]:.1f} / {scores[1]:.3f} / {scores[2]:.3f}"


def main() -> None:
    """Print the table; draw the pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--pairs", type=Path, default=SHARED / "denoise")
    parser.add_argument("--pictures", type=Path)
    arguments = parser.parse_args()
    meshlab_spectral.load()
    names = arguments.names or [
        file.name.removesuffix("_noisy.ply") for file in sorted(arguments.pairs.glob("*_noisy.ply"))
    ]
    table: dict[str, dict[str, Array]] = {}
    for name in names:
        pair = Pair(arguments.pairs, name)
        print(f"\n{name}{' (constants chosen on it)' if name in CHOSEN_ON else ''}")
        table.setdefault("noisy", {})[name] = pair.scores([pair.V])[0]
        panels = [Panel("noisy", pair.V, pair.F)]
        for label, (method, values) in METHODS.items():
            start = time.perf_counter()
            shapes = [method(pair.V, pair.F, *([] if v is None else [v])) for v in values]
            seconds = (time.perf_counter() - start) / len(values)
            scores = pair.scores(shapes)
            best = int(np.argmin(scores[:, 0]))
            lines = {label: 0} if len(values) == 1 else {label: 0, f"{label}, best": best}
            for line, index in lines.items():
                table.setdefault(line, {})[name] = scores[index]
                print(f"  {line:30}{told(scores[index])}  {values[index] or ''}  {seconds:.2f} s")
            if label in ("Spectral Denoise", "MeshLab Taubin", "bilateral normals"):
                last = list(lines)[-1]
                panels.append(Panel(last, shapes[best], pair.F))
        if arguments.pictures and name in PICTURED:
            clean = pyvista.read(pair.clean)
            panels.append(Panel("clean", np.asarray(clean.points, float), pair.F))
            arguments.pictures.mkdir(parents=True, exist_ok=True)
            picture = arguments.pictures / f"{name}.png"
            draw_side_by_side(panels, picture, view=View.of_widest_side(pair.V))
    for group, members in GROUPS.items():
        present = [name for name in members if name in names]
        if present:
            print(f"\n{group}: mean of {', '.join(present)}")
            for line, scores in table.items():
                print(f"  {line:30}{told(np.mean([scores[name] for name in present], axis=0))}")


if __name__ == "__main__":
    main()
