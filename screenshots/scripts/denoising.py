"""Pictures of Spectral Denoise next to MeshLab's Taubin smoothing at its best, and the truth.

The noisy meshes and the measure are those of tests/benchmarks/bench_denoise.py, whose folder must
be on Python's path.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bench_denoise import METHODS, Pair
from figure_numbers import Drawing, MeshFile, Numbers
from meshlab_spectral import denoise_mesh
from meshlab_spectral.figures.pictures import Image, Panel, View
from side_by_side import save, side_by_side

# From the folder of the meshes.
PAIRS, LOCAL_PAIRS = "../denoise", "../denoise_local"


@dataclass(frozen=True)
class Detail:
    """The part of a mesh that is drawn, as seen: its centre and half width, relative to the mesh.

    Of a part smaller than the mesh, only the front.
    """

    middle: tuple[float, float] = (0.5, 0.5)
    radius: float = 1.0


def denoise(mesh: MeshFile) -> Drawing:
    """Show a Kinect scan, the surface of a segmentation, and a head with spikes."""
    return _drawing(
        mesh,
        {
            "kinect_Cone": Detail(),
            "stair64x1_igea": Detail(),
            "pierrot_i3": Detail((0.47, 0.7), 0.27),
        },
    )


def trimstar(mesh: MeshFile) -> Drawing:
    """Show a machine part with noise of 0.3 edges."""
    return _drawing(mesh, {"trimstar_n3": Detail()})


def local(mesh: MeshFile) -> Drawing:
    """Show a part, a building and a scan with noise in some places only."""
    names = ("half-boxy", "facade00-20", "real30-bunny")
    return _drawing(mesh, {name: Detail() for name in names}, LOCAL_PAIRS)


def _drawing(mesh: MeshFile, details: dict[str, Detail], folder: str = PAIRS) -> Drawing:
    """Make a picture with a row for each pair."""
    rows: list[tuple[list[Panel], Detail]] = []
    numbers: Numbers = {}
    for name, detail in details.items():
        pair = Pair(mesh(f"{folder}/{name}_noisy.ply").parent, name)
        taubin, counts = METHODS["Taubin"]
        smoothed = [taubin(pair.V, pair.F, count) for count in counts]
        shapes = {
            "before": pair.V,
            "Spectral Denoise": denoise_mesh(pair.V, pair.F)[0],
            "Taubin, best": min(smoothed, key=pair.angle),
        }
        panels = []
        for label, V in shapes.items():
            angle = pair.angle(V)
            numbers[f"{name}, {label}: mean angle to the truth, degrees"] = angle
            panels.append(Panel(f"{label}, {angle:.1f}\N{DEGREE SIGN}", V, pair.F))
        rows.append(([*panels, pair.truth()], detail))
    return Drawing(numbers, functools.partial(_draw, rows))


def _draw(rows: list[tuple[list[Panel], Detail]], path: Path) -> None:
    save(np.concatenate([_row(panels, detail) for panels, detail in rows]), path)


def _row(panels: list[Panel], detail: Detail) -> Image:
    view = View.of_widest_side(panels[0].V)
    seen = panels[0].V @ view.axes().T
    low, extent = seen.min(axis=0), np.ptp(seen, axis=0)
    parts = []
    for panel in panels:
        at = (panel.V @ view.axes().T - low) / extent
        near = np.abs(at[:, :2] - detail.middle).max(axis=1) < detail.radius
        near &= (at[:, 2] > 0.6) | (detail.radius == 1.0)
        used, faces = np.unique(panel.F[near[panel.F].all(axis=1)], return_inverse=True)
        parts.append(Panel(panel.label, panel.V[used], faces.reshape(-1, 3)))
    return side_by_side(parts, view=view, panel_size=(400, 400))


PICTURES: dict[str, Callable[[MeshFile], Drawing]] = {
    "denoise": denoise,
    "denoise_local": local,
    "denoise_trimstar_n3": trimstar,
}
