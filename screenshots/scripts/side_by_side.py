"""Meshes side by side in one picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from meshlab_spectral.figures.pictures import Frame, Image, Panel, View, bounding_box, scene
from meshlab_spectral.files.whole_files import writing_whole


def draw_side_by_side(
    panels: Sequence[Panel],
    path: Path,
    *,
    view: View | None = None,
    panel_size: tuple[int, int] = (800, 800),
) -> None:
    """Draw meshes side by side into a .png file; see `side_by_side`."""
    save(side_by_side(panels, view=view, panel_size=panel_size), path)


def side_by_side(
    panels: Sequence[Panel], *, view: View | None = None, panel_size: tuple[int, int] = (800, 800)
) -> Image:
    """Draw meshes side by side, with the same camera, so that sizes can be compared.

    Parameters
    ----------
    panels
        The meshes from left to right; the camera is centred on the first.
    view
        The viewpoint; by default in front of the xy plane.
    panel_size
        Width and height of each panel in pixels.

    Returns
    -------
    numpy.ndarray
        Height x width x 3 levels from 0 to 255.

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
        image: Image = plotter.screenshot(return_img=True)
    finally:
        plotter.close()
    return image


def save(image: Image, path: Path) -> None:
    """Write a .png file, as small as it can be."""
    from PIL import Image as Picture

    with writing_whole(path) as scratch:
        Picture.fromarray(image).save(scratch, optimize=True)
