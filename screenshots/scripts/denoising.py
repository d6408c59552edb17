"""Pictures of Spectral Denoise next to MeshLab's Taubin smoothing at its best, and the truth.

The noisy meshes and the measure are those of tests/benchmarks/bench_denoise.py, whose folder must
be on Python's path.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from bench_denoise import Pair
from denoising_methods import METHODS
from figure_numbers import Drawing, MeshFile, Numbers
from meshlab_spectral import denoise_mesh
from meshlab_spectral.figures.pictures import Image, Panel, View
from numpy.typing import NDArray
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
    """Show a part, a building and a scan with noise in some places only, and where it was found."""
    names = ("half-boxy", "facade00-20", "real30-bunny")
    return _drawing(mesh, {name: Detail() for name in names}, LOCAL_PAIRS, with_heights=True)


def _drawing(
    mesh: MeshFile, details: dict[str, Detail], folder: str = PAIRS, *, with_heights: bool = False
) -> Drawing:
    """Make a picture with a row for each pair, and the height of the noise at each vertex."""
    rows: list[tuple[list[Panel], Detail]] = []
    numbers: Numbers = {}
    for name, detail in details.items():
        pair = Pair(mesh(f"{folder}/{name}_noisy.ply").parent, name)
        taubin, counts = METHODS["Taubin"]
        smoothed = [taubin(pair.V, pair.F, count) for count in counts]
        denoised, report = denoise_mesh(pair.V, pair.F, store_noise_height=True)
        shapes = {
            "before": pair.V,
            "Spectral Denoise": denoised,
            "Taubin, best": min(smoothed, key=pair.angle),
        }
        panels = []
        for label, V in shapes.items():
            angle = pair.angle(V)
            numbers[f"{name}, {label}: mean angle to the truth, degrees"] = angle
            panels.append(Panel(f"{label}, {angle:.1f}\N{DEGREE SIGN}", V, pair.F))
        if with_heights:
            heights = np.asarray(report["noise_heights"]) / report["mean_edge"]
            numbers[f"{name}: largest height of the noise, edges"] = heights.max()
            panels.insert(1, _map_of_heights(heights, pair))
        rows.append(([*panels, pair.truth()], detail))
    return Drawing(numbers, functools.partial(_draw, rows))


def _map_of_heights(heights: NDArray[np.float64], pair: Pair) -> Panel:
    """Colour the noisy mesh from grey, no noise, to red, the largest height."""
    label = f"noise: 0 to {heights.max():.2f} edges"
    return Panel(label, pair.V, pair.F, signed=heights / heights.max(), zero_line=False)


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
        signed = None if panel.signed is None else panel.signed[used]
        parts.append(replace(panel, V=panel.V[used], F=faces.reshape(-1, 3), signed=signed))
    return side_by_side(parts, view=view, panel_size=(400, 400))


PICTURES: dict[str, Callable[[MeshFile], Drawing]] = {
    "denoise": denoise,
    "denoise_local": local,
    "denoise_trimstar_n3": trimstar,
}
