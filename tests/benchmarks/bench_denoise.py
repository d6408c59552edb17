"""Denoising against ground truth: noisy meshes whose clean originals are known.

usage: bench_denoise.py [--pairs FOLDER] [--all-methods] [--rivals] [NAME ...]
       bench_denoise.py --clean [MESH ...]
       bench_denoise.py --estimates [MESH ...]
       bench_denoise.py --relief

For every pair NAME_noisy.ply, NAME_clean.ply: mean angle between the face normals in degrees / mean
distance of the vertices from their clean positions along the normals, in mean edges; before, after
Spectral Denoise with its defaults, and after MeshLab's smoothing filters at their best, with the
number of steps that has the least angle for each mesh. For NAME_surface.ply, the true surface of a
staircase as another mesh, the angle is between the normals of nearest points. Seconds are those of
a pymeshlab call; their ratio is to those of MeshLab's Taubin smoothing with 50 steps.
FOLDER defaults to ../shared/denoise next to the repository. --all-methods adds VTK's windowed sinc
and bilateral normals. --rivals adds, at fixed options, as nobody can choose with the truth, the
denoisers of Debian's meshsdfilter-tools (MeshDenoiser; Zhang et al. 2018), with the defaults that
AliceVision gives it, and of MeshLib (`pip install meshlib`): each if it is installed.

--clean: the largest displacement on meshes without noise, by default those of ../shared, some also
decimated; and the angle before and after with 0.05 mean edges of noise added.

--estimates: for every MESH, by default some of ../shared/data, without noise and with noise of
known kind and height: the estimate, and the root mean square distance of the vertices from their
positions without noise, before and after; all in mean edges.

--relief: sheets of 60 x 60 vertices with ribs, waves, threads or knurls, 4, 6 or 8 edges apart, and
noise of 0.1, 0.2 and 0.3 edges in all directions (fixed seeds): part of the relief that is left
away from the rim, and the angle before, after, and after the best Taubin smoothing.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import meshlab_spectral
import numpy as np
import pymeshlab
import pyvista
import scipy.sparse as sp
from denoising_methods import (
    METHODS,
    MORE_METHODS,
    Array,
    Method,
    face_normals,
    load,
    rivals,
    same_vertices,
    unit,
)
from meshlab_spectral.figures.pictures import Panel
from meshlab_spectral.filters.arrays import mean_edge
from numpy.typing import NDArray

REPOSITORY = Path(__file__).resolve().parents[2]
SHARED = REPOSITORY.parent / "shared"
GROUPS = {
    "smooth shapes": ("igea_n3", "Nicolo0.2", "julius_n2", "child_n3"),
    "machine parts": ("trimstar_n3", "Fandisk0.3", "Block0.4"),
    "synthetic": tuple(
        f"{shape}_n{noise}"
        for shape in [
            "block",
            "bumpy_torus",
            "cube",
            "eight",
            "elephant",
            "genus3",
            "joint",
            "plane-sphere",
            "star",
        ]
        for noise in (1, 2, 3)
    ),
}
ESTIMATED = (
    "fandisk.off",
    "stanford-bunny.obj",
    "igea.ply",
    "hippo.ply",
    "camelhead.off",
    "dragon_40k.ply",
    "lionstatue.obj",
    "rocker-arm.obj",
)
DECIMATED = ("stanford-bunny.obj", "igea.ply", "fandisk.off")


def vertex_normals(V: Array, F: Any) -> Array:
    """Unit normals of the vertices, weighted by area."""
    N = np.zeros_like(V)
    for corner in range(3):
        np.add.at(N, F[:, corner], face_normals(V, F))
    return unit(N)


def mean_angle(M: Array, N: Array) -> float:
    """Mean angle between unit vectors, in degrees."""
    return float(np.degrees(np.arccos(np.clip((M * N).sum(1), -1, 1))).mean())


class Pair:
    """A noisy mesh and its truth: the same mesh without noise, or a surface."""

    def __init__(self, folder: Path, name: str) -> None:
        self.V, self.F = load(folder / f"{name}_noisy.ply")
        self.clean: Array | None = None
        if (folder / f"{name}_clean.ply").exists():
            self.clean = load(folder / f"{name}_clean.ply")[0]
            normals = face_normals(self.clean, self.F)
            area = np.linalg.norm(normals, axis=1)
            self._faces = np.flatnonzero(area > 1e-9 * area.mean())
            self._normals = unit(normals[self._faces])
            self._edge = mean_edge(self.clean, self.F)
        else:
            self.surface = pyvista.read(folder / f"{name}_surface.ply").compute_normals(
                point_normals=False, auto_orient_normals=False, consistent_normals=False
            )
            self._faces = np.random.default_rng(0).permutation(len(self.F))[:6000]

    def truth(self) -> Panel:
        """The truth, to draw."""
        if self.clean is not None:
            return Panel("truth", self.clean, self.F)
        return Panel("truth", np.asarray(self.surface.points), self.surface.regular_faces)

    def angle(self, V: Array) -> float:
        """Mean angle to the normals of the truth, degrees."""
        F = self.F[self._faces]
        N = unit(face_normals(V, F))
        if self.clean is not None:
            return mean_angle(N, self._normals)
        nearest = self.surface.find_closest_cell(V[F].mean(1))
        M = np.asarray(self.surface.cell_data["Normals"], float)[nearest]
        return mean_angle(N, M * np.sign((M * N).sum(1).mean()))

    def distance(self, V: Array) -> float:
        """Mean distance of the vertices to their places along the normals, in edges."""
        if self.clean is None:
            return np.nan
        along = ((V - self.clean) * vertex_normals(self.clean, self.F)).sum(1)
        return float(np.abs(along).mean() / self._edge)


def timed(method: Callable[[], Any]) -> tuple[Any, float]:
    """Call twice; return the result and the shorter time."""
    seconds = []
    for _ in range(2):
        begin = time.perf_counter()
        result = method()
        seconds.append(time.perf_counter() - begin)
    return result, min(seconds)


def print_pairs(
    folder: Path, names: list[str], methods: dict[str, tuple[Method, list[Any]]]
) -> None:
    """Print a line for every pair, and the means of groups."""
    taubin = METHODS["Taubin"][0]
    print(
        f"{'':20}{'noisy':>14}{'Spectral Denoise':>18}",
        *(f"{m:>13}" for m in methods),
        "  times",
    )
    angles: dict[str, list[float]] = {}
    ratios = []
    for name in names:
        pair = Pair(folder, name)
        (X, report), seconds = timed(lambda p=pair: meshlab_spectral.denoise_mesh(p.V, p.F))
        reference = timed(lambda p=pair: taubin(p.V, p.F, 50))[1]
        best, spent = [], []
        for method, values in methods.values():
            begin = time.perf_counter()
            shapes = [same_vertices(method, pair.V, pair.F, value) for value in values]
            spent.append((time.perf_counter() - begin) / len(values) / reference)
            best.append(min(shapes, key=pair.angle))
        shapes = [pair.V, X, *best]
        angles[name] = [pair.angle(shape) for shape in shapes]
        ratios.append(seconds / reference)
        cells = [
            f"{a:7.2f} /{pair.distance(s):6.3f}" for a, s in zip(angles[name], shapes, strict=True)
        ]
        times = " ".join(f"{ratio:.2f}" for ratio in [ratios[-1], *spent])
        print(f"{name:20}", *cells, f" {times}  {report['summary']}", flush=True)
    for group, members in GROUPS.items():
        present = [angles[name] for name in members if name in angles]
        if present:
            means = np.mean(present, axis=0)
            print(f"{group} ({len(present)}):", *(f"{mean:.2f}" for mean in means))
    worse = [n for n, a in angles.items() if a[1] > min(a[3:4]) + 0.3]
    print(f"more than 0.3 above Taubin's best: {', '.join(worse) or 'none'}")
    print(f"time over Taubin, 50 steps: at most {max(ratios):.2f}, mean {np.mean(ratios):.2f}")


def noise_of(kind: str, height: float, V: Array, F: Any) -> Array:
    """Seeded noise along the normals of the vertices, `height` mean edges high."""
    random = np.random.default_rng(1)
    values = random.standard_normal(len(V))
    if kind == "correlated":  # over about one and a half edges
        i, j = F.ravel(), np.roll(F, 1, axis=1).ravel()
        A = sp.csr_matrix((np.ones(len(i)), (i, j)), (len(V), len(V)))
        A = A + A.T
        degree = np.maximum(np.asarray(A.sum(1)).ravel(), 1)
        for _ in range(2):
            values = (values + A @ values / degree) / 2
        values /= values.std()
    if kind == "spikes":  # one vertex in ten
        values = np.sign(values) * (random.random(len(V)) < 0.1)
    return vertex_normals(V, F) * (height * mean_edge(V, F) * values)[:, None]


def print_estimates(files: list[Path]) -> None:
    """Print estimates, displacements and remaining errors for noise of known height."""
    for file in files:
        V, F = load(file)
        edge = mean_edge(V, F)
        print(f"\n{file.name}: {len(V)} vertices")
        kinds = [
            ("none", 0.0),
            *(("white", height) for height in (0.05, 0.1, 0.2, 0.4)),
        ]
        for kind, height in [*kinds, ("correlated", 0.4), ("spikes", 0.7)]:
            X = V + (noise_of(kind, height, V, F) if height else 0.0)
            Y, report = meshlab_spectral.denoise_mesh(X, F)
            before, after = (np.sqrt(((Z - V) ** 2).sum(1).mean()) / edge for Z in (X, Y))
            found = report["estimated_noise_height"] / edge
            print(
                f"  {kind:10} {height:4.2f}: estimated {found:.3f}, distance {before:.4f} -> "
                f"{after:.4f}; {report['summary'][:60]}"
            )


def clean_meshes(given: list[str]) -> Iterator[tuple[str, Array, NDArray[Any]]]:
    """Yield meshes without noise, and decimated ones."""
    files = [Path(name) for name in given]
    if not given:
        folders = [SHARED / "cad", SHARED / "data"]
        files = [file for folder in folders for file in sorted(folder.iterdir())]
        files += sorted((SHARED / "denoise").glob("*_clean.ply"))
    for file in files:
        if file.suffix.lower() in (".ply", ".obj", ".off", ".stl"):
            yield (file.name, *load(file))
    for name in () if given else DECIMATED:
        for faces in (8000, 5000, 3000, 2000, 1000, 600, 300):
            meshes = pymeshlab.MeshSet()
            meshes.load_new_mesh(str(SHARED / "data" / name))
            meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=faces)
            mesh = meshes.current_mesh()
            yield (
                f"{name}, {faces} faces",
                mesh.vertex_matrix().copy(),
                mesh.face_matrix().copy(),
            )


class CleanRow(NamedTuple):
    """What denoising does to a mesh without noise, and to that mesh with a little."""

    name: str
    moved: float
    """Largest displacement, in mean edges."""
    before: float
    after: float
    """Mean angle to the normals of the mesh, with noise of 0.05 mean edges added, in degrees."""
    summary: str


def clean_rows(given: list[str]) -> Iterator[CleanRow]:
    """Denoise meshes without noise, and with a little added."""
    for name, V, F in clean_meshes(given):
        if len(F) == 0:
            continue
        edge, N = mean_edge(V, F), unit(face_normals(V, F))
        X, report = meshlab_spectral.denoise_mesh(V, F)
        random = np.random.default_rng(5)
        noisy = V + vertex_normals(V, F) * (0.05 * edge * random.standard_normal(len(V)))[:, None]
        Y = meshlab_spectral.denoise_mesh(noisy, F)[0]
        before, after = (mean_angle(unit(face_normals(Z, F)), N) for Z in (noisy, Y))
        yield CleanRow(name, np.abs(X - V).max() / edge, before, after, report["summary"])


def print_clean(given: list[str]) -> None:
    """Print what moves where nothing should, and how much of a little noise remains."""
    rows = []
    for row in clean_rows(given):
        rows.append(row)
        print(
            f"{row.name:36} moved {row.moved:.4f} edges; noise of 0.05 edges: {row.before:5.2f} -> "
            f"{row.after:5.2f} degrees; {row.summary[:60]}",
            flush=True,
        )
    moved, worse = (
        sum(row.moved > 0 for row in rows),
        sum(row.after > row.before for row in rows),
    )
    print(f"{len(rows)} meshes: {moved} moved; with noise added, {worse} are worse than before")


def sheet(kind: str, pitch: int, height: float) -> tuple[Array, Any]:
    """A sheet with relief of a height over its mean, 60 x 60 vertices one unit apart."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(60.0), np.arange(60.0)))
    wave = 2 * np.pi / pitch
    s = np.sqrt(0.5)
    z = {
        "ribs": np.clip(1.6 * np.cos(wave * x + 0.3), -1, 1),
        "waves": np.cos(wave * (0.92 * x + 0.39 * y) + 0.6 * np.sin(2 * np.pi * y / 37)),
        "threads": 4 * np.abs(((x + 0.17 * y) / pitch + 0.1) % 1 - 0.5) - 1,
        "knurls": (np.cos(wave * s * (x + y) + 0.3) + np.cos(wave * s * (x - y) + 0.8)) / 2,
    }[kind]
    at = np.arange(3600).reshape(60, 60)
    a, b, c, d = (q.ravel() for q in (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]))
    odd = (np.add.outer(np.arange(59), np.arange(59)) % 2 == 1).ravel()
    F = np.concatenate(
        [
            np.c_[a, b, c][~odd],
            np.c_[a, c, d][~odd],
            np.c_[a, b, d][odd],
            np.c_[b, c, d][odd],
        ]
    )
    return np.c_[x, y, height * z], F


def print_relief() -> None:
    """Relief kept and angles on sheets with noise."""
    heights, noises = (0.25, 0.5, 1.0), (0.1, 0.2, 0.3)
    taubin, all_steps = METHODS["Taubin"]
    print("relief   apart height noise | kept | before  after  Taubin, best")
    rows: dict[float, list[tuple[float, ...]]] = {}
    for kind in ("ribs", "waves", "threads", "knurls"):
        for pitch in (4, 6, 8):
            for height in heights:
                W, F = sheet(kind, pitch, height)
                inner = ((W[:, :2] > 8) & (W[:, :2] < 51)).all(axis=1)
                for seed, noise in enumerate(noises):
                    V = W + np.random.default_rng([pitch, seed]).normal(0, noise, W.shape)
                    X, _ = meshlab_spectral.denoise_mesh(V, F)
                    kept = (X[inner, 2] @ W[inner, 2]) / (W[inner, 2] @ W[inner, 2])
                    N = unit(face_normals(W, F))
                    shapes = [V, X, *(taubin(V, F, steps) for steps in all_steps)]
                    angles = [mean_angle(unit(face_normals(Y, F)), N) for Y in shapes]
                    before, after, best = angles[0], angles[1], min(angles[2:])
                    rows.setdefault(height, []).append((kept, before, after, best))
                    print(
                        f"{kind:8s} {pitch:5d} {height:6.2f} {noise:5.1f} | {100 * kept:3.0f} % |"
                        f" {before:6.2f} {after:6.2f} {best:6.2f}",
                        flush=True,
                    )
    for height, found in rows.items():
        kept, before, after, best = np.array(found).T
        print(
            f"height {height}: of {len(found)} sheets {(kept < 0.85).sum()} keep less than"
            f" 85 %, the least {100 * kept.min():.0f} %; {(after > before).sum()} worse than"
            f" before; {before.mean():.1f} -> {after.mean():.1f}, Taubin {best.mean():.1f} degrees"
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--pairs", type=Path, default=SHARED / "denoise")
    parser.add_argument("--all-methods", action="store_true")
    parser.add_argument("--rivals", action="store_true")
    parser.add_argument("--clean", action="store_true")
    parser.add_argument("--estimates", action="store_true")
    parser.add_argument("--relief", action="store_true")
    arguments = parser.parse_args()
    meshlab_spectral.load()
    if arguments.estimates:
        given = [Path(name) for name in arguments.names]
        print_estimates(given or [SHARED / "data" / name for name in ESTIMATED])
    elif arguments.clean:
        print_clean(arguments.names)
    elif arguments.relief:
        print_relief()
    else:
        names = arguments.names or [
            file.name.removesuffix("_noisy.ply")
            for file in sorted(arguments.pairs.glob("*_noisy.ply"))
        ]
        more = MORE_METHODS if arguments.all_methods else {}
        print_pairs(
            arguments.pairs,
            names,
            METHODS | more | (rivals() if arguments.rivals else {}),
        )


if __name__ == "__main__":
    main()
