"""A comparison of two meshes as a picture, and as a coloured mesh file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from meshlab_spectral.figures.pictures import SIGNED_COLOURS, Frame, Panel, View, render
from meshlab_spectral.figures.sheet import Sheet
from meshlab_spectral.figures.signed_mesh import write_signed
from meshlab_spectral.files.comparison import Comparison


def colour_extent(comparison: Comparison) -> float:
    """Return the deviation at full colour: all but a hundredth of the surface has less.

    If that is 0 it is the largest one, and 1 between equal meshes.
    """
    deviation = comparison.deviations["normal" if comparison.same_faces else "b_to_a"]
    return deviation.percentiles[99] or abs(deviation.largest) or 1.0


def draw_comparison(
    comparison: Comparison, path: Path, names: tuple[str, str], scale: float = 1.0
) -> None:
    """Draw both meshes and the deviation of b to a .png file: red is outside a, blue inside.

    All three have the same light and camera. `names` are those of the meshes. Raises MeshFileError
    when `path` cannot be written.
    """
    (V, F), (W, G) = comparison.a, comparison.b
    extent = colour_extent(comparison)
    share = np.clip(comparison.signed / extent, -1, 1)
    panels = [
        Panel(names[0], V, F.astype(np.int64)),
        Panel(names[1], W, G.astype(np.int64)),
        Panel("deviation", W, G.astype(np.int64), share),
    ]
    frame = Frame.around([V, W], View.of_widest_side(V))
    sheet = Sheet([frame.width / frame.height], len(panels), 1, scale, footer=0.56)
    for column, panel in enumerate(panels):
        sheet.picture(0, column, render(panel, frame, sheet.pixels), panel.label)
    labels = (f"\N{MINUS SIGN}{extent:.3g}", "0", f"{extent:.3g}")
    sheet.colour_bar(SIGNED_COLOURS, labels, "red: outside, in the units of the file")
    sheet.save(path)


def write_comparison(comparison: Comparison, scratch: Path) -> None:
    """Write mesh b as .ply with the deviation as quality and in colours, for MeshLab."""
    write_signed(*comparison.b, comparison.signed, colour_extent(comparison), scratch)
