"""Denoising against ground truth: noisy meshes whose clean originals are known.

usage: bench_denoise.py [--pairs FOLDER] [--pictures FOLDER] [NAME ...]
       bench_denoise.py --estimates [MESH ...]

For every pair NAME_noisy.ply, NAME_clean.ply and every method: mean angle between the normals of
the faces in degrees / mean distance to the clean surface / mean distance of a vertex to its clean
place, both in mean edges. Methods with a parameter have two lines: at its default, and at its best,
the value with the least angle, chosen for each mesh by its clean original. Spectral Denoise has
nothing to choose. FOLDER defaults to ../shared/denoise beside the repository, the measure is
denoise_score.py beside FOLDER. --pictures writes pictures of four of the meshes
side by side, and of a raw scan.

--estimates: for every MESH, by default some of ../shared/data, without noise and with noise of
known kind and height: the estimate, and the root mean square distance of the vertices to where they
were without it, before and after; all in mean edges.
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
from meshlab_spectral.filters.arrays import mean_edge
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
ESTIMATED = (
    "rocker-arm.obj",
    "fandisk.off",
    "gears.stl",
    "stanford-bunny.obj",
    "dragon_40k.ply",
    "lionstatue.obj",
    "rangescan_lato000.ply",
)
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


def bilateral_normals(V: Array, F: Any, chosen: tuple[float, int] = (0.35, 20)) -> Array:
    """Bilateral normal filtering, local scheme (Zheng, Fu, Au, Tai 2011), from its equations."""
    sigma, iterations = chosen
    rows = np.repeat(np.arange(len(F)), 3)
    of_vertex = sp.csr_matrix((np.ones(F.size), (F.ravel(), rows)), (len(V), len(F)))
    pairs = (of_vertex.T @ of_vertex).tocoo()  # faces with a common vertex
    a, b = pairs.row[pairs.row != pairs.col], pairs.col[pairs.row != pairs.col]
    sides = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    area = np.linalg.norm(sides, axis=1)
    N, centre = sides / np.maximum(area, 1e-300)[:, None], V[F].mean(1)
    distance = np.linalg.norm(centre[a] - centre[b], axis=1)
    near = area[b] * np.exp(-((distance / distance.mean()) ** 2) / 2)
    for _ in range(iterations):
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
    "bilateral normals": (
        bilateral_normals,
        [None, *((sigma, k) for sigma in (0.2, 0.3, 0.45, 0.6) for k in (1, 2, 5, 10, 20))],
    ),
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


def noise_of(kind: str, height: float, V: Array, F: Any) -> Array:
    """Seeded noise along the normals of the vertices, `height` mean edges high."""
    random = np.random.default_rng(1)
    sides = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    N = np.zeros_like(V)
    for corner in range(3):
        np.add.at(N, F[:, corner], sides)
    N /= np.maximum(np.linalg.norm(N, axis=1), 1e-300)[:, None]
    values = random.standard_normal(len(V))
    if kind == "correlated":  # over about three edges
        i, j = F.ravel(), np.roll(F, 1, axis=1).ravel()
        A = sp.csr_matrix((np.ones(len(i)), (i, j)), (len(V), len(V)))
        A = A + A.T
        degree = np.maximum(np.asarray(A.sum(1)).ravel(), 1)
        for _ in range(6):
            values = (values + A @ values / degree) / 2
        values /= values.std()
    if kind == "outliers":  # one vertex in a hundred
        values *= random.random(len(V)) < 0.01
    return N * (height * mean_edge(V, F) * values)[:, None]


def print_estimates(files: list[Path]) -> None:
    """Print what is found, moved and left on meshes with noise of known height."""
    for file in files:
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(str(file))
        V = meshes.current_mesh().vertex_matrix().copy()
        F = meshes.current_mesh().face_matrix().copy()
        edge = mean_edge(V, F)
        print(f"\n{file.name}: {len(V)} vertices")
        kinds = [("none", 0.0), *(("white", height) for height in (0.05, 0.1, 0.2, 0.4))]
        for kind, height in [*kinds, ("correlated", 0.2), ("outliers", 1.0)]:
            X = V + (noise_of(kind, height, V, F) if height else 0.0)
            start = time.perf_counter()
            Y, report = meshlab_spectral.denoise_mesh(X, F)
            seconds = time.perf_counter() - start
            before, after = (np.sqrt(((Z - V) ** 2).sum(1).mean()) / edge for Z in (X, Y))
            found, rounds = report["estimated_noise_height"] / edge, report["rounds"]
            print(
                f"  {kind:10} {height:4.2f}: estimated {found:.3f}, "
                f"distance {before:.4f} -> {after:.4f}, {rounds:2} rounds, {seconds:.2f} s"
            )


def draw_scan(file: Path, picture: Path) -> None:
    """Draw the middle of a raw scan before and after, and print what is left of its noise."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(file))
    V = meshes.current_mesh().vertex_matrix().copy()
    F = meshes.current_mesh().face_matrix().copy()
    middle = np.abs(V[:, :2] - V[:, :2].mean(0)) < 0.12 * np.ptp(V, axis=0).max()
    near = F[middle.all(1)[F].all(1)]
    used, faces = np.unique(near, return_inverse=True)
    panels = [Panel("range scan", V[used], faces.reshape(-1, 3))]
    print(f"\n{file.name}")
    for label, options in {"default": {}, "noise_height 0.1e": {"noise_height": "0.1e"}}.items():
        X, report = meshlab_spectral.denoise_mesh(V, F, **options)
        left = meshlab_spectral.denoise_mesh(X, F)[1]["estimated_noise_height"]
        edge = report["mean_edge"]
        print(
            f"  {label}: noise {report['estimated_noise_height'] / edge:.3f} -> {left / edge:.3f} "
            f"edges, moved by {report['rms_displacement'] / edge:.3f}; {report['fixed_vertices']} "
            f"vertices on rims, of {(X == V).all(1).sum()} that have not moved"
        )
        panels.append(Panel(label, X[used], faces.reshape(-1, 3)))
    draw_side_by_side(panels, picture, panel_size=(400, 400))


def told(scores: Array) -> str:
    """Format three scores."""
    return f"{scores[0]:.1f} / {scores[1]:.3f} / {scores[2]:.3f}"


def main() -> None:
    """Print the table; draw the pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--pairs", type=Path, default=SHARED / "denoise")
    parser.add_argument("--pictures", type=Path)
    parser.add_argument("--estimates", action="store_true")
    arguments = parser.parse_args()
    meshlab_spectral.load()
    if arguments.estimates:
        given = [Path(name) for name in arguments.names]
        print_estimates(given or [SHARED / "data" / name for name in ESTIMATED])
        return
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
            picture = arguments.pictures / f"denoise_{name}.png"
            view = View.of_widest_side(pair.V)
            draw_side_by_side(panels, picture, view=view, panel_size=(400, 400))
    scan = SHARED / "data" / "rangescan_lato000.ply"
    if arguments.pictures and scan.exists():
        draw_scan(scan, arguments.pictures / "denoise_rangescan.png")
    for group, members in GROUPS.items():
        present = [name for name in members if name in names]
        if present:
            print(f"\n{group}: mean of {', '.join(present)}")
            for line, scores in table.items():
                print(f"  {line:30}{told(np.mean([scores[name] for name in present], axis=0))}")


if __name__ == "__main__":
    main()
