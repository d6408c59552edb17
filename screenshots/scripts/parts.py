"""Pictures of what the filters do beyond a low-pass of a whole mesh.

Each function computes one picture from a mesh of the collection.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from figure_numbers import Drawing, MeshFile, Numbers, diagonal, displacement, labelled
from meshlab_spectral.figures.pictures import Frame, Panel, View, render
from meshlab_spectral.figures.sheet import FONT_SIZE, INK, Sheet
from meshlab_spectral.files.comparison import compare
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.filters.arrays import lumped_areas, mean_edge
from meshlab_spectral.filters.fractional import filter_mesh
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.signals import filter_colors, filter_scalars
from meshlab_spectral.filters.transfer import MeshLengths, gain
from meshlab_spectral.plugin.loading import FILTER_NAME, load
from numpy.typing import NDArray
from stability import LOW_PASS, schemes
from subject import scheme_name, subject_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# Percent of the diagonal, and gain: from the shape of the body to the scales.
BANDS = ((30, 1.0), (12, 2.2), (5, 0.25), (2, 1.5))
SCALE = 0.5  # of the pages, to keep files small

SHADES = (0.02, 1.0)  # excludes 0, where a line would be drawn
FULL_RED = 0.005  # length of artefacts, in diagonals
BOUND = 0.3  # percent of the diagonal, of a low-pass that moves vertices by up to some times that


@dataclass(frozen=True)
class Row:
    """Meshes side by side, seen from the same viewpoint."""

    panels: list[Panel]
    view: View


class Bar(NamedTuple):
    """A colour bar; see `Sheet.colour_bar`."""

    labels: tuple[str, str, str]
    caption: str
    least: float = 0.0


def _up_to(share: float, what: str) -> Bar:
    """Return a bar for lengths up to a share of the diagonal, in percent."""
    return Bar(("0", f"{share / 2:.2g} %", f"{share:.2g} %"), f"{what}, % of the diagonal")


def _drawing(
    numbers: Numbers,
    *rows: Row,
    plot: Callable[[Axes], None] | None = None,
    scale: float = SCALE,
    bar: Bar | None = None,
) -> Drawing:
    """Make a picture of rows of meshes; `plot` fills one more column on the right."""
    return Drawing(numbers, functools.partial(_draw, rows, plot, scale, bar))


def _draw(
    rows: tuple[Row, ...],
    plot: Callable[[Axes], None] | None,
    scale: float,
    bar: Bar | None,
    path: Path,
) -> None:
    frames = [Frame.around([panel.V for panel in row.panels], row.view) for row in rows]
    columns = len(rows[0].panels)
    aspects = [frame.width / frame.height for frame in frames]
    lines = max(1 + panel.label.count("\n") for row in rows for panel in row.panels)
    footer = 0.0 if bar is None else 0.56
    sheet = Sheet(aspects, columns + (plot is not None), lines, scale, footer)
    for i, (row, frame) in enumerate(zip(rows, frames, strict=True)):
        for j, panel in enumerate(row.panels):
            sheet.picture(i, j, render(panel, frame, sheet.pixels), panel.label)
    if plot is not None:
        plot(sheet.plot(0, columns))
    if bar is not None:
        sheet.colour_bar(bar.labels, bar.caption, bar.least)
    sheet.save(path)


def equalizer(mesh: MeshFile) -> Drawing:
    """Show the dragon, the dragon after an equalizer of four bands, and its curve."""
    V, F = load_arrays(mesh("dragon_40k.ply"))
    points = ", ".join(f"{size}%:{factor}" for size, factor in BANDS)
    options = FilterOptions(filter_type="custom", transfer_function=points)
    Y, _ = filter_mesh(V, F, **options.as_dict())
    panels = [Panel("original", V, F), Panel(f"transfer_function\n{points}", Y, F)]
    lengths = MeshLengths(0.05 * diagonal(V), diagonal(V), mean_edge(V, F))
    plot = functools.partial(_plot_bands, options, lengths)
    return _drawing(displacement(V, F, Y), Row(panels, View.of_widest_side(V)), plot=plot)


def _plot_bands(options: FilterOptions, lengths: MeshLengths, axes: Axes) -> None:
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


def selection(mesh: MeshFile) -> Drawing:
    """Show the bunny with its head selected, and after a low-pass of the selection."""
    import pymeshlab

    V, F = load_arrays(mesh("stanford-bunny.obj"))
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
    full = float(np.quantile(distance, 0.99))
    panels = [
        Panel("selected", V, F, np.clip(selected, *SHADES)),
        Panel("low-pass 15 % of the selection", Y, F),
        Panel("how far each vertex moved", Y, F, np.clip(distance / full, *SHADES)),
    ]
    numbers = displacement(V, F, Y)
    numbers["vertices selected, %"] = 100 * float(np.mean(selected > 0))
    numbers["vertices moved, %"] = 100 * float(np.mean(distance > 0))
    bar = _up_to(100 * full / diagonal(V), "right: displacement")
    return _drawing(numbers, Row(panels, View()), bar=bar)


def color_by_displacement(mesh: MeshFile) -> Drawing:
    """Show the bunny after a low-pass, in colours by the displacement, and with a bound on it."""
    V, F = load_arrays(mesh("stanford-bunny.obj"))
    panels = [Panel("original", V, F)]
    numbers: Numbers = {}
    extent = BOUND / 100 * diagonal(V)
    for label, more in (("low-pass 10 %", {}), ("max_displacement", {"max_displacement": extent})):
        Y, _ = filter_mesh(V, F, FilterOptions(feature_size="10%", **more))
        if not more:
            panels.append(Panel(label, Y, F))
            label = "colour by displacement"
        numbers |= labelled(label, displacement(V, F, Y))
        largest = numbers[f"{label}: largest displacement, %"]
        outward = np.clip(compare((V, F), (Y, F)).signed / extent, -1, 1)
        label = f"{label}\nat most {largest:.2g} % of the diagonal"
        panels.append(Panel(label, Y, F, outward, zero_line=False))
    caption = f"red: outwards, blue: inwards; full colours from {BOUND:g} % of the diagonal on"
    bar = Bar((f"\N{MINUS SIGN}{BOUND:g} %", "0", f"{BOUND:g} %"), caption, -1.0)
    return _drawing(numbers, Row(panels, View()), bar=bar)


def bounded(mesh: MeshFile) -> Drawing:
    """Show a statue after a low-pass, and where a bound on displacements is reached: no ridge."""
    V, F = load_arrays(mesh("lionstatue.obj"))
    free, _ = filter_mesh(V, F, feature_size="8%")
    limited, report = filter_mesh(V, F, feature_size="8%", max_displacement="0.5%")
    moved = [np.linalg.norm(Y - V, axis=1) for Y in (free, limited)]
    bound = 0.005 * diagonal(V)
    panels = [
        Panel("statue", V, F),
        Panel("low-pass 8 %", free, F),
        Panel("moved by .5 % at most", limited, F),
        Panel("red: at the bound", limited, F, np.clip(moved[1] / bound, *SHADES)),
    ]
    numbers = displacement(V, F, limited)
    numbers["without a bound, %"] = 100 * float(moved[0].max()) / diagonal(V)
    numbers["bound reached, % of the surface"] = 100 * report["limited_share"]
    return _drawing(numbers, Row(panels, View()), bar=_up_to(0.5, "right: displacement"))


def creases(mesh: MeshFile) -> Drawing:
    """Show machine parts with noise, and after a low-pass without and with a crease angle."""
    fandisk, of_fandisk = _creases(mesh("fandisk.off"), 0.1)
    gears, of_gears = _creases(mesh("gears.stl"), 0.03)
    return _drawing(
        of_fandisk | of_gears,
        Row(fandisk, View((0.6, 1.0, 0.7), (0.0, 0.0, 1.0))),
        Row(gears, View((0.3, -0.5, 1.0), (0.0, 1.0, 0.0))),
        scale=0.8 * SCALE,
    )


def _creases(source: Path, noise: float) -> tuple[list[Panel], Numbers]:
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
    panels: list[Panel] = []
    numbers: Numbers = {}
    for label, Y in shapes.items():
        error = _mean_angle(Y, V, F)
        numbers[f"{source.stem}, {label}: mean error of the normals, degrees"] = error
        label = f"{label}\nnormals off by {error:.1f}\N{DEGREE SIGN}"
        # Every triangle has its own vertices, to be shaded flat.
        panels.append(Panel(label, Y[F].reshape(-1, 3), np.arange(F.size).reshape(-1, 3)))
    return panels, numbers


def _mean_angle(Y: Array, V: Array, F: Indices) -> float:
    """Return the mean angle between the normals of two shapes, degrees, weighted by V's areas."""
    ofY, ofV = (np.cross(X[F[:, 1]] - X[F[:, 0]], X[F[:, 2]] - X[F[:, 0]]) for X in (Y, V))
    angles = np.arctan2(np.linalg.norm(np.cross(ofY, ofV), axis=1), np.sum(ofY * ofV, axis=1))
    return float(np.degrees(np.average(angles, weights=np.linalg.norm(ofV, axis=1))))


def quality(mesh: MeshFile) -> Drawing:
    """Show a scalar field on the bunny, with noise, and the noisy one after a low-pass."""
    V, F = load_arrays(mesh("stanford-bunny.obj"))
    x, y, z = (V - V.min(axis=0)).T / diagonal(V)
    field = np.sin(22 * x + 8 * np.sin(7 * y)) * np.cos(9 * z + 12 * y)
    noisy = field + 0.5 * np.random.default_rng(1).standard_normal(len(V))
    clean, _ = filter_scalars(V, F, noisy, feature_size="7%")
    areas = lumped_areas(V, F)
    panels: list[Panel] = []
    numbers: Numbers = {}
    for label, values in (("field", field), ("with noise", noisy), ("low-pass 7 %", clean)):
        if values is not field:
            error = float(np.sqrt(np.average((values - field) ** 2, weights=areas)))
            numbers[f"{label}: rms error"] = error
            label = f"{label}\nrms error {error:.2f}"
        panels.append(Panel(label, V, F, np.clip(values, -1, 1), zero_line=False))
    bar = Bar(("\N{MINUS SIGN}1", "0", "1"), "value at each vertex", -1.0)
    return _drawing(numbers, Row(panels, View()), bar=bar)


def colors(mesh: MeshFile) -> Drawing:
    """Show a painting on the bunny, with noise, and the noisy one after a low-pass."""
    V, F = load_arrays(mesh("stanford-bunny.obj"))
    x, y, z = (V - V.min(axis=0)).T / diagonal(V)
    patches = np.tanh(12 * np.sin(14 * x + 4 * np.sin(9 * y)) * np.cos(11 * z + 9 * y))[:, None]
    brown, cream = np.array([120.0, 70.0, 40.0]), np.array([235.0, 220.0, 190.0])
    painting = (brown + cream) / 2 + patches * (cream - brown) / 2
    noisy = np.clip(painting + 30 * np.random.default_rng(1).standard_normal(V.shape), 0, 255)
    clean, _ = filter_colors(V, F, noisy / 255, feature_size="6%")
    clean *= 255
    areas = lumped_areas(V, F)
    panels: list[Panel] = []
    numbers: Numbers = {}
    for label, levels in (("painting", painting), ("with noise", noisy), ("low-pass 6 %", clean)):
        if levels is not painting:
            squares = np.mean((levels - painting) ** 2, axis=1)
            error = float(np.sqrt(np.average(squares, weights=areas)))
            numbers[f"{label}: rms error of 255"] = error
            label = f"{label}\nrms error {error:.0f} of 255"
        panels.append(Panel(label, V, F, colors=np.round(levels).astype(np.uint8)))
    return _drawing(numbers, Row(panels, View()))


def artefacts(mesh: MeshFile) -> Drawing:
    """Show the dragon after a low-pass in three schemes, coloured by the artefacts they leave."""
    subject = subject_of(mesh("dragon_40k.ply"))
    panels: list[Panel] = []
    numbers: Numbers = {}
    for options in schemes(LOW_PASS):
        size = subject.artefact_numbers(options)
        label = scheme_name(options)
        numbers |= labelled(label, size)
        rms, largest = (f"{percent:.2g} %" for percent in size.values())
        shares = subject.artefacts(options).length / subject.diagonal / FULL_RED
        label = f"{label}\nartefacts: rms {rms}, largest {largest}"
        panels.append(Panel(label, subject.filtered(options), subject.F, np.clip(shares, *SHADES)))
    bar = _up_to(100 * FULL_RED, "length of artefacts")
    return _drawing(numbers, Row(panels, subject.view), bar=bar)


PICTURES: dict[str, Callable[[MeshFile], Drawing]] = {
    "equalizer": equalizer,
    "selection": selection,
    "color_by_displacement": color_by_displacement,
    "max_displacement": bounded,
    "creases": creases,
    "quality": quality,
    "colors": colors,
    "artefacts": artefacts,
}
