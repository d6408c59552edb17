"""Pictures of what the filters do beyond a low-pass of a whole mesh.

`parts.py MESHES PICTURES [NAME ...]` draws equalizer, selection, creases, quality, colors and
artefacts into the folder PICTURES, from dragon_40k.ply, stanford-bunny.obj, fandisk.off and
gears.stl in the folder MESHES.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from meshlab_spectral.figures.pictures import Frame, Panel, View, render
from meshlab_spectral.figures.sheet import FONT_SIZE, INK, Sheet
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.filters.arrays import lumped_areas, mean_edge
from meshlab_spectral.filters.artefacts import measure_artefacts
from meshlab_spectral.filters.fractional import filter_mesh
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.signals import filter_colors, filter_scalars
from meshlab_spectral.filters.transfer import MeshLengths, gain
from meshlab_spectral.plugin.loading import FILTER_NAME, load
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# Percent of the diagonal, and gain: from the shape of the body to the scales.
BANDS = ((30, 1.0), (12, 2.2), (5, 0.25), (2, 1.5))
SCALE = 0.5  # of the pages, to keep files small

SHADES = (0.02, 1.0)  # excludes 0, where a line would be drawn
FULL_RED = 0.005  # length of artefacts, in diagonals


def _diagonal(V: Array) -> float:
    return float(np.linalg.norm(np.ptp(V, axis=0)))


def _row(panels: list[Panel], view: View, curves: int = 0) -> Sheet:
    """Draw panels side by side; `curves` columns to the right stay empty."""
    frame = Frame.around([panel.V for panel in panels], view)
    sheet = Sheet([frame.width / frame.height], len(panels) + curves, 2, SCALE)
    for column, panel in enumerate(panels):
        sheet.picture(0, column, render(panel, frame, sheet.pixels), panel.label)
    return sheet


def equalizer(meshes: Path, path: Path) -> None:
    """Draw the dragon, the dragon after an equalizer of four bands, and its curve."""
    V, F = load_arrays(meshes / "dragon_40k.ply")
    points = ", ".join(f"{size}%:{factor}" for size, factor in BANDS)
    options = FilterOptions(filter_type="custom", transfer_function=points)
    Y, _ = filter_mesh(V, F, **options.as_dict())
    panels = [Panel("original", V, F), Panel(f"transfer_function\n{points}", Y, F)]
    sheet = _row(panels, View.of_widest_side(V), 1)
    lengths = MeshLengths(0.05 * _diagonal(V), _diagonal(V), mean_edge(V, F))
    _plot_bands(sheet.plot(0, 2), options, lengths)
    sheet.save(path)


def _plot_bands(axes: Axes, options: FilterOptions, lengths: MeshLengths) -> None:
    sizes = np.geomspace(60, 1, 300)
    gains = gain(options, lengths.feature_size / (sizes / 100 * lengths.diagonal), lengths)
    axes.plot(sizes, gains, color="#b04607", linewidth=1.5)
    axes.plot(*zip(*BANDS, strict=True), "o", color="#b04607", markersize=5)
    axes.axhline(1, color="#a0a0a0", linewidth=0.7, linestyle=(0, (4, 3)))
    axes.set_xscale("log")
    axes.set_xlim(sizes[0], sizes[-1])
    axes.set_ylim(0, 2.5)
    axes.set_xticks([size for size, _ in BANDS], [f"{size}" for size, _ in BANDS])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("feature size, % of the diagonal", fontsize=FONT_SIZE - 1, color=INK)
    axes.set_ylabel("gain", fontsize=FONT_SIZE - 1, color=INK)


def selection(meshes: Path, path: Path) -> None:
    """Draw the bunny with its head selected, and after a low-pass of the selection."""
    import pymeshlab

    V, F = load_arrays(meshes / "stanford-bunny.obj")
    load()
    mesh_set = pymeshlab.MeshSet()
    mesh_set.add_mesh(pymeshlab.Mesh(V, F))
    low, size = V.min(axis=0), np.ptp(V, axis=0)
    x, face, ears = low[0] + 0.36 * size[0], low[1] + 0.57 * size[1], low[1] + 0.68 * size[1]
    condition = f"(y0 > {face} && x0 < {x}) || y0 > {ears}"
    mesh_set.compute_selection_by_condition_per_face(condselect=condition)
    selected = np.zeros(len(V))
    selected[F[mesh_set.current_mesh().face_selection_array()]] = 0.8
    mesh_set.apply_filter(FILTER_NAME, feature_size=pymeshlab.PercentageValue(15))
    Y = mesh_set.current_mesh().vertex_matrix().copy()
    distance = np.linalg.norm(Y - V, axis=1)
    moved = distance / np.quantile(distance, 0.99)
    panels = [
        Panel("selected", V, F, np.clip(selected, *SHADES)),
        Panel("low-pass 15 % of the selection", Y, F),
        Panel("how far each vertex moved", Y, F, np.clip(moved, *SHADES)),
    ]
    _row(panels, View()).save(path)


def creases(meshes: Path, path: Path) -> None:
    """Draw machine parts with noise, and after a low-pass without and with a crease angle."""
    rows = [
        _creases(meshes / "fandisk.off", 0.1, View((0.6, 1.0, 0.7), (0.0, 0.0, 1.0))),
        _creases(meshes / "gears.stl", 0.03, View((0.3, -0.5, 1.0), (0.0, 1.0, 0.0))),
    ]
    frames = [Frame.around([panel.V for panel in panels], view) for panels, view in rows]
    sheet = Sheet([frame.width / frame.height for frame in frames], 3, 2, 0.8 * SCALE)
    for i, (panels, _) in enumerate(rows):
        for j, panel in enumerate(panels):
            sheet.picture(i, j, render(panel, frames[i], sheet.pixels), panel.label)
    sheet.save(path)


def _creases(source: Path, noise: float, view: View) -> tuple[list[Panel], View]:
    import pymeshlab

    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(source))
    mesh_set.meshing_remove_duplicate_vertices()  # an .stl file has three for each triangle
    V = mesh_set.current_mesh().vertex_matrix().copy()
    F = mesh_set.current_mesh().face_matrix().astype(np.int64)
    edge = mean_edge(V, F)
    X = V + noise * edge * np.random.default_rng(1).standard_normal(V.shape)
    size = str(6 * edge)
    shapes = {
        f"noise of {noise:g} mean edges": X,
        "low-pass, 6 mean edges": filter_mesh(X, F, feature_size=size)[0],
        "crease_angle 50": filter_mesh(X, F, feature_size=size, crease_angle=50.0)[0],
    }
    panels = []
    for label, Y in shapes.items():
        error = _mean_angle(Y, V, F)
        print(f"{source.name}, {label}: mean error of the normals {error:.1f} degrees")
        label = f"{label}\nnormals off by {error:.1f}\N{DEGREE SIGN}"
        # Every triangle has its own vertices, to be shaded flat.
        panels.append(Panel(label, Y[F].reshape(-1, 3), np.arange(F.size).reshape(-1, 3)))
    return panels, view


def _mean_angle(Y: Array, V: Array, F: Indices) -> float:
    """Return the mean angle between the normals of two shapes, degrees, weighted by V's areas."""
    ofY, ofV = (np.cross(X[F[:, 1]] - X[F[:, 0]], X[F[:, 2]] - X[F[:, 0]]) for X in (Y, V))
    angles = np.arctan2(np.linalg.norm(np.cross(ofY, ofV), axis=1), np.sum(ofY * ofV, axis=1))
    return float(np.degrees(np.average(angles, weights=np.linalg.norm(ofV, axis=1))))


def quality(meshes: Path, path: Path) -> None:
    """Draw a scalar field on the bunny, with noise, and the noisy one after a low-pass."""
    V, F = load_arrays(meshes / "stanford-bunny.obj")
    x, y, z = (V - V.min(axis=0)).T / _diagonal(V)
    field = np.sin(22 * x + 8 * np.sin(7 * y)) * np.cos(9 * z + 12 * y)
    noisy = field + 0.5 * np.random.default_rng(1).standard_normal(len(V))
    clean, _ = filter_scalars(V, F, noisy, feature_size="7%")
    areas = lumped_areas(V, F)
    panels = []
    for label, values in (("field", field), ("with noise", noisy), ("low-pass 7 %", clean)):
        error = np.sqrt(np.average((values - field) ** 2, weights=areas))
        label = label if values is field else f"{label}\nrms error {error:.2f}"
        panels.append(Panel(label, V, F, np.clip(0.5 + 0.7 * values, *SHADES)))
    _row(panels, View()).save(path)


def colors(meshes: Path, path: Path) -> None:
    """Draw a painting on the bunny, with noise, and the noisy one after a low-pass."""
    V, F = load_arrays(meshes / "stanford-bunny.obj")
    x, y, z = (V - V.min(axis=0)).T / _diagonal(V)
    patches = np.tanh(12 * np.sin(14 * x + 4 * np.sin(9 * y)) * np.cos(11 * z + 9 * y))[:, None]
    brown, cream = np.array([120.0, 70.0, 40.0]), np.array([235.0, 220.0, 190.0])
    painting = (brown + cream) / 2 + patches * (cream - brown) / 2
    noisy = np.clip(painting + 30 * np.random.default_rng(1).standard_normal(V.shape), 0, 255)
    clean, _ = filter_colors(V, F, noisy / 255, feature_size="6%")
    clean *= 255
    areas = lumped_areas(V, F)
    panels = []
    for label, levels in (("painting", painting), ("with noise", noisy), ("low-pass 6 %", clean)):
        error = np.sqrt(np.average(np.mean((levels - painting) ** 2, axis=1), weights=areas))
        label = label if levels is painting else f"{label}\nrms error {error:.0f} of 255"
        panels.append(Panel(label, V, F, colors=np.round(levels).astype(np.uint8)))
    _row(panels, View()).save(path)


def artefacts(meshes: Path, path: Path) -> None:
    """Draw the dragon after a low-pass in three schemes, coloured by the artefacts they leave."""
    V, F = load_arrays(meshes / "dragon_40k.ply")
    size, shapes = 0.15 * _diagonal(V), {}
    for label, scheme in (
        ("one shot", {"steps": 1}),
        ("10 steps, full update", {"steps": 10, "basis_update": "full"}),
        ("10 steps, conformal update", {"steps": 10, "basis_update": "conformal"}),
    ):
        shapes[label] = filter_mesh(V, F, feature_size=str(size), **scheme)[0]
    panels = []
    for label, Y in shapes.items():
        found = measure_artefacts(Y, F, size)
        rms, most = (f"{100 * one / _diagonal(V):.2g} %" for one in (found.rms, found.maximum))
        shares = found.length / _diagonal(V) / FULL_RED
        label = f"{label}\nartefacts: rms {rms}, largest {most}"
        panels.append(Panel(label, Y, F, np.clip(shares, *SHADES)))
    _row(panels, View.of_widest_side(V)).save(path)


PICTURES = {
    "equalizer": equalizer,
    "selection": selection,
    "creases": creases,
    "quality": quality,
    "colors": colors,
    "artefacts": artefacts,
}


if __name__ == "__main__":
    if len(sys.argv) < 3 or not PICTURES.keys() >= set(sys.argv[3:]):
        sys.exit(__doc__)
    for name in sys.argv[3:] or PICTURES:
        PICTURES[name](Path(sys.argv[1]), Path(sys.argv[2], f"{name}.png"))
