"""Pictures of meshes, drawn without a screen. Needs the extra `pictures` (PyVista)."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import SpectralError

if TYPE_CHECKING:
    import pymeshlab


@dataclass(frozen=True)
class Panel:
    """One mesh of a picture.

    Attributes
    ----------
    label
        Short text under the mesh.
    V
        n x 3 coordinates.
    F
        m x 3 indices of the corners of triangles.
    """

    label: str
    V: NDArray[np.float64]
    F: NDArray[np.int64]

    @classmethod
    def of(cls, label: str, mesh: pymeshlab.Mesh) -> Panel:
        """Take the triangles of a mesh of pymeshlab."""
        return cls(label, mesh.vertex_matrix().copy(), mesh.face_matrix().astype(np.int64))


@dataclass(frozen=True)
class View:
    """Where the camera stands, seen from the middle of the first mesh.

    Attributes
    ----------
    direction
        From the mesh towards the camera.
    up
        What is up in the picture.
    zoom
        1 fits the bounding sphere of the first mesh into a panel.
    """

    direction: tuple[float, float, float] = (0.0, 0.0, 1.0)
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    zoom: float = 1.0


def draw_side_by_side(
    panels: Sequence[Panel],
    path: Path,
    *,
    view: View | None = None,
    panel_size: tuple[int, int] = (800, 800),
) -> None:
    """Draw meshes beside each other, all from the same camera, so that sizes can be compared.

    Parameters
    ----------
    panels
        The meshes from left to right. The first one sets where the camera looks.
    path
        The picture to write, a .png file.
    view
        Where the camera stands; by default in front of the xy plane.
    panel_size
        Width and height of one panel in pixels.

    Raises
    ------
    SpectralError
        When PyVista is not installed.
    """
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        # Without this VTK first tries, and warns about, the X server that is not there.
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    try:
        import pyvista
    except ModuleNotFoundError as error:
        raise SpectralError(
            f"pictures need PyVista ({error}): pip install 'meshlab-spectral[pictures]'"
        ) from error

    view = view or View()
    width, height = panel_size
    plotter = pyvista.Plotter(
        off_screen=True,
        shape=(1, len(panels)),
        window_size=[width * len(panels), height],
        border=False,
        lighting="none",
    )
    try:
        plotter.set_background("white")
        camera = _camera(panels[0], view)
        for column, panel in enumerate(panels):
            plotter.subplot(0, column)
            plotter.add_mesh(_surface(panel), color="#c9c2b4", smooth_shading=True, specular=0.05)
            plotter.add_text(
                panel.label, position="lower_edge", font_size=15, color="#202020", shadow=False
            )
            plotter.camera_position = camera
            plotter.camera.parallel_projection = True
            plotter.camera.parallel_scale = _radius(panels[0]) / view.zoom
            plotter.reset_camera_clipping_range()
        for light in _lights(pyvista):
            plotter.add_light(light)  # to all panels at once
        plotter.enable_anti_aliasing("ssaa")
        plotter.screenshot(str(path))
    finally:
        plotter.close()


def _surface(panel: Panel) -> Any:
    import pyvista

    surface = pyvista.PolyData.from_regular_faces(panel.V, panel.F)
    # Normals of our own, whole and unsplit: smooth_shading would cut the surface at sharp edges.
    return surface.compute_normals(
        cell_normals=False, split_vertices=False, consistent_normals=False
    )


def _camera(panel: Panel, view: View) -> list[tuple[float, ...]]:
    middle = (panel.V.min(axis=0) + panel.V.max(axis=0)) / 2
    direction = np.asarray(view.direction) / np.linalg.norm(view.direction)
    position = middle + 10 * _radius(panel) * direction
    return [tuple(position), tuple(middle), view.up]


def _radius(panel: Panel) -> float:
    """Half of the largest extent, with a margin for the label."""
    return 0.62 * float(np.ptp(panel.V, axis=0).max())


def _lights(pyvista: Any) -> list[Any]:
    """Key light from the upper left, fill from the right: both move with the camera.

    No part of a surface faces both, so they stay below full white and no relief is lost.
    """
    key = pyvista.Light(position=(-0.9, 0.9, 0.6), light_type="camera light", intensity=1.15)
    fill = pyvista.Light(position=(1.0, 0.0, 0.7), light_type="camera light", intensity=0.55)
    return [key, fill]
