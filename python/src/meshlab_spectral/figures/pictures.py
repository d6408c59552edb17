"""Off-screen rendering of meshes. Needs the extra `render` (PyVista)."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.extras import check_extras

Image = NDArray[np.uint8]

SIGNED_COLOURS = "coolwarm"  # grey at zero, which stands out from the white page


@dataclass(frozen=True)
class Panel:
    """A mesh in a picture."""

    label: str  # short text under the mesh
    V: NDArray[np.float64]  # n x 3 coordinates
    F: NDArray[np.int64]  # m x 3 vertex indices of triangles
    # n values to colour the mesh by, from -1 (blue) to 1 (red); a line marks 0 (grey).
    signed: NDArray[np.float64] | None = None
    # n x 3 levels of red, green and blue, 0 to 255, in place of `signed`.
    colors: NDArray[np.uint8] | None = None
    zero_line: bool = True  # whether the line is drawn; where values are rough it would cover them


@dataclass(frozen=True)
class View:
    """A viewpoint."""

    direction: tuple[float, float, float] = (0.0, 0.0, 1.0)  # direction from the mesh to the camera
    # Up direction of the picture; not parallel to `direction`.
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)

    @classmethod
    def of_widest_side(cls, V: NDArray[np.float64]) -> View:
        """Look along the shortest axis of the bounding box, from its positive side.

        Up is y, or z if y is the shortest axis: this suits models with either convention.
        """
        shortest = int(np.argmin(np.ptp(V, axis=0)))
        x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
        return cls((x, y, z)[shortest], z if shortest == 1 else y)

    def axes(self) -> NDArray[np.float64]:
        """Return unit vectors to the right, up and towards the camera, as rows."""
        back = np.asarray(self.direction) / np.linalg.norm(self.direction)
        right = np.cross(self.up, back)
        right /= np.linalg.norm(right)
        return np.array([right, np.cross(back, right), back])


@dataclass(frozen=True)
class Frame:
    """The rectangle shown by a picture, in parallel projection."""

    view: View  # the viewpoint
    middle: NDArray[np.float64]  # point at the centre of the picture
    # Its size in the units of the mesh.
    width: float
    height: float

    @classmethod
    def around(cls, shapes: Sequence[NDArray[np.float64]], view: View) -> Frame:
        """Fit several meshes, each n x 3 coordinates, with a narrow margin."""
        return cls.row_by_row([shapes], view)[0]

    @classmethod
    def row_by_row(cls, rows: Sequence[Sequence[NDArray[np.float64]]], view: View) -> list[Frame]:
        """Fit rows of meshes: all frames have the same width, each row has its own height."""
        axes = view.axes()
        boxes = [bounding_box([V @ axes.T for V in row]) for row in rows]
        left = min(low[0] for low, _ in boxes)
        right = max(high[0] for _, high in boxes)
        margin = 0.02 * (right - left)
        frames = []
        for low, high in boxes:
            low[0], high[0] = left, right
            width, height = (high - low)[:2] + margin
            frames.append(cls(view, (low + high) / 2 @ axes, float(width), float(height)))
        return frames


def scene(
    panels: Sequence[Panel],
    frame: Frame,
    columns: int,
    panel_size: tuple[int, int],
    *,
    font_size: int,
    off_screen: bool = True,
) -> Any:
    """Set up a plot of meshes in rows; raises MissingPackageError without PyVista.

    Row by row, `panels` are shown in `columns`, each with the rectangle of the `frame`, in
    `panel_size`, width and height in pixels; `font_size` is that of the labels. Returns a
    pyvista.Plotter to be closed by the caller, without a window if it is `off_screen`.
    """
    plotter = _plotter((ceil(len(panels) / columns), columns), panel_size, off_screen)
    for cell, panel in enumerate(panels):
        plotter.subplot(*divmod(cell, columns))
        _add(plotter, panel, frame)
        plotter.add_text(
            panel.label, position="lower_edge", font_size=font_size, color="#202020", shadow=False
        )
    return plotter


def render(panel: Panel, frame: Frame, pixels: int) -> Image:
    """Draw one mesh, without its label, as height x width x 3 levels from 0 to 255.

    `pixels` is the width of the picture; the height follows from the rectangle to show. Raises
    MissingPackageError without PyVista.
    """
    height = max(1, round(pixels * frame.height / frame.width))
    plotter = _plotter((1, 1), (2 * pixels, 2 * height))
    try:
        _add(plotter, panel, frame)
        fine = plotter.screenshot(return_img=True)
    finally:
        plotter.close()
    # Supersampled in addition to VTK's antialiasing, for spikes thinner than a pixel.
    image: Image = fine.reshape(height, 2, pixels, 2, 3).mean(axis=(1, 3)).round().astype(np.uint8)
    return image


def to_full_colours(values: NDArray[np.float64], areas: NDArray[np.float64]) -> NDArray[np.float64]:
    """Scale n values to -1 .. 1, clipping the extreme hundredth of the area, mostly spikes.

    Only the area where there are values counts: most harmonics of several components are zero, up
    to round-off, on all but one.
    """
    height = np.abs(values)
    order = np.argsort(height)
    order = order[height[order] > 1e-6 * height.max()]
    if len(order) == 0:
        return np.zeros_like(values)
    areas = areas[order]
    reached = np.searchsorted(np.cumsum(areas), 0.99 * areas.sum())
    largest = height[order[min(reached, len(order) - 1)]]
    scaled: NDArray[np.float64] = np.clip(values / largest, -1, 1)
    return scaled


def _plotter(shape: tuple[int, int], panel_size: tuple[int, int], off_screen: bool = True) -> Any:
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        # Otherwise VTK first tries an X server, and warns that there is none.
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    check_extras("render")
    import pyvista

    rows, columns = shape
    width, height = panel_size
    plotter = pyvista.Plotter(
        off_screen=off_screen,
        shape=shape,
        window_size=[width * columns, height * rows],
        border=False,
        lighting="none",
    )
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    return plotter


def _add(plotter: Any, panel: Panel, frame: Frame) -> None:
    """Add a mesh, its lights and its camera to the plotter's current panel."""
    surface = _surface(panel)
    if panel.colors is not None:
        plotter.add_mesh(surface, scalars=panel.colors, rgb=True, smooth_shading=True, specular=0.0)
    elif panel.signed is None:
        plotter.add_mesh(surface, color="#c9c2b4", smooth_shading=True, specular=0.05)
    else:
        surface["signed"] = panel.signed
        plotter.add_mesh(
            surface,
            scalars="signed",
            cmap=SIGNED_COLOURS,
            clim=(-1, 1),
            smooth_shading=True,
            specular=0.0,
            show_scalar_bar=False,
        )
        zero = surface.contour([0.0], scalars="signed")
        if panel.zero_line and zero.n_points:
            # Slightly in front of the surface, which would otherwise hide half the line.
            zero.translate(2e-3 * frame.height * frame.view.axes()[2], inplace=True)
            plotter.add_mesh(zero, color="#404040", line_width=5, lighting=False)
    for light in _lights():
        plotter.add_light(light, only_active=True)  # else it lights all other panels, too
    back = frame.view.axes()[2]
    distance = 10 * max(frame.width, frame.height)
    plotter.camera_position = [
        tuple(frame.middle + distance * back),
        tuple(frame.middle),
        frame.view.up,
    ]
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = frame.height / 2
    plotter.reset_camera_clipping_range()


def _surface(panel: Panel) -> Any:
    import pyvista

    surface = pyvista.PolyData.from_regular_faces(panel.V, panel.F)
    # Explicit vertex normals: smooth_shading would split the surface at sharp edges.
    return surface.compute_normals(
        cell_normals=False, split_vertices=False, consistent_normals=False
    )


def bounding_box(shapes: Sequence[NDArray[np.float64]]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the lowest and highest corner of the bounding box of several meshes."""
    return (
        np.min([V.min(axis=0) for V in shapes], axis=0),
        np.max([V.max(axis=0) for V in shapes], axis=0),
    )


def _lights() -> list[Any]:
    """Key light from the upper left, fill light from the right, both fixed to the camera.

    No part of a surface faces both, so it never saturates and no relief is lost.
    """
    import pyvista

    key = pyvista.Light(position=(-0.9, 0.9, 0.6), light_type="camera light", intensity=1.15)
    fill = pyvista.Light(position=(1.0, 0.0, 0.7), light_type="camera light", intensity=0.55)
    return [key, fill]
