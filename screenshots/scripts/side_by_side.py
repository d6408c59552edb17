"""Meshes side by side in one picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from meshlab_spectral.figures.pictures import Frame, Panel, View, bounding_box, scene


def draw_side_by_side(
    panels: Sequence[Panel],
    path: Path,
    *,
    view: View | None = None,
    panel_size: tuple[int, int] = (800, 800),
) -> None:
    """Draw meshes side by side, with the same camera, so that sizes can be compared.

    Parameters
    ----------
    panels
        The meshes from left to right; the camera is centred on the first.
    path
        The .png file to write.
    view
        The viewpoint; by default in front of the xy plane.
    panel_size
        Width and height of each panel in pixels.

    Raises
    ------
    MissingPackageError
        When PyVista is not installed.
    """
    # The largest extent, with a margin for the label.
    low, high = bounding_box([panels[0].V])
    height = 1.24 * float((high - low).max())
    frame = Frame(view or View(), (low + high) / 2, height, height)
    plotter = scene(panels, frame, len(panels), panel_size, font_size=15)
    try:
        plotter.screenshot(str(path))
    finally:
        plotter.close()
