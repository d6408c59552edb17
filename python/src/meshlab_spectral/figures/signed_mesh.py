"""A signed number at each vertex of a mesh, as a picture and in a mesh file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.figures.pictures import Frame, Panel, View, render
from meshlab_spectral.figures.sheet import Sheet
from meshlab_spectral.files.comparison import signed_colours

Array = NDArray[np.float64]


def signed_sheet(
    meshes: Sequence[tuple[str, Array, NDArray[Any]]],
    label: str,
    values: Array,
    extent: float,
    caption: str,
) -> Sheet:
    """Draw meshes, and the last of them again in colours.

    All have the same light and camera. Colours are blue, grey and red for -extent, 0 and extent.

    Parameters
    ----------
    meshes
        Labels, coordinates and triangles.
    label, values
        The label of the coloured picture, and the values at the vertices of the last mesh.
    extent, caption
        Value at full colour, and what the colours mean.
    """
    panels = [Panel(name, V, F.astype(np.int64)) for name, V, F in meshes]
    last = panels[-1]
    share = np.clip(values / extent, -1, 1)
    panels.append(Panel(label, last.V, last.F, share, zero_line=False))
    frame = Frame.around([panel.V for panel in panels], View.of_widest_side(last.V))
    sheet = Sheet([frame.width / frame.height], len(panels), 1, footer=0.56)
    for column, panel in enumerate(panels):
        sheet.picture(0, column, render(panel, frame, sheet.pixels), panel.label)
    labels = (f"\N{MINUS SIGN}{extent:.3g}", "0", f"{extent:.3g}")
    sheet.colour_bar(labels, f"{caption}, in the units of the mesh")
    return sheet


def write_signed(V: Array, F: NDArray[Any], values: Array, extent: float, scratch: Path) -> None:
    """Write a mesh as .ply: blue, white and red are -extent, 0 and extent, as in MeshLab."""
    import plyfile

    columns = [(name, "f8") for name in ("x", "y", "z", "quality")]
    columns += [(name, "u1") for name in ("red", "green", "blue")]
    vertices = np.empty(len(V), columns)
    for name, coordinates in zip("xyz", V.T, strict=True):
        vertices[name] = coordinates
    vertices["quality"] = values
    colours = signed_colours(values, extent)
    for name, levels in zip(("red", "green", "blue"), colours.T, strict=True):
        vertices[name] = levels
    faces = np.empty(len(F), [("vertex_indices", "i4", (3,))])
    faces["vertex_indices"] = F
    elements = [
        plyfile.PlyElement.describe(vertices, "vertex"),
        plyfile.PlyElement.describe(faces, "face"),
    ]
    plyfile.PlyData(elements).write(scratch)
