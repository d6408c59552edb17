"""Pictures of a mesh's manifold harmonics: for `meshlab-spectral basis`, and for notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil
from operator import index
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import ArrayError, OptionError
from meshlab_spectral.figures.pictures import (
    Frame,
    Panel,
    View,
    render,
    scene,
    to_full_colours,
)
from meshlab_spectral.figures.sheet import Sheet
from meshlab_spectral.filters.arrays import check_class, mesh_arrays
from meshlab_spectral.filters.harmonics import Harmonics
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone

if TYPE_CHECKING:
    from pyvista import Plotter

# Default number of pictures, and how many in a row.
_SHOWN = 12
_COLUMNS, _COLUMNS_UPRIGHT = 4, 6
# Coloured pictures compress worse than the others: this keeps the file to a megabyte.
_RESOLUTION = 0.92
# In pixels, for notebooks.
_PANEL_WIDTH, _LABEL_HEIGHT = 320, 46


def spread_modes(first: int, size: int) -> list[int]:
    """Choose harmonics from `first` to the last of `size`, geometrically spaced."""
    modes = [first]
    for ideal in np.geomspace(1, max(size - first, 1), _SHOWN)[1:]:
        modes.append(max(modes[-1] + 1, first - 1 + round(ideal)))
    return [mode for mode in modes if mode < size]


def check_modes(modes: Sequence[int], size: int) -> None:
    """Raise OptionError unless there are modes, all of them in a basis of `size` harmonics."""
    if len(modes) == 0:
        raise OptionError("no modes to show: name at least one")
    for mode in modes:
        if not 0 <= mode < size:
            raise OptionError(f"mode {mode}: a basis of {size} harmonics has modes 0 to {size - 1}")


def draw_basis_file(
    archive: Path, path: Path, modes: Sequence[int] | None = None, scale: float = 1.0
) -> None:
    """Draw harmonics to a .png file: red is positive, blue negative, a line marks zero.

    `archive` was written by `meshlab-spectral basis`. The picture is written atomically; a `scale`
    of 1 fills a screen. The default is a dozen modes, from the first non-constant one to the last.
    Raises OptionError when a mode is not in the basis, MeshFileError when `path` cannot be written.
    """
    with np.load(archive) as arrays:
        basis = Harmonics(arrays["eigenvalues"], arrays["harmonics"], arrays["masses"])
        V, F = arrays["vertices"], arrays["faces"]
    panels = _panels(basis, V, F, modes)
    frame = Frame.around([V], View.of_widest_side(V))
    columns = _columns(len(panels), frame)
    rows = ceil(len(panels) / columns)
    sheet = Sheet([frame.width / frame.height] * rows, columns, 2, _RESOLUTION * scale, footer=0.56)
    for cell, panel in enumerate(panels):
        picture = render(panel, frame, sheet.pixels)
        sheet.picture(*divmod(cell, columns), picture, panel.label)
    sheet.colour_bar(("\N{MINUS SIGN}", "0", "+"), "wavelengths in % of the model's diagonal")
    sheet.save(path)


@takes_mesh_alone
def plot_harmonics(
    mesh_or_vertices: Any,
    faces: ArrayLike | None,
    harmonics: Harmonics,
    indices: Sequence[int] | None = None,
    *,
    off_screen: bool = True,
) -> Plotter:
    """Plot harmonics on their mesh: red is positive, blue negative, a line marks zero.

    All views share one camera. Wavelengths are in percent of the bounding box diagonal, like
    feature sizes.

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `manifold_harmonics`.
    harmonics
        Harmonics of this mesh, as from `manifold_harmonics`.
    indices
        Which to show, from 0; by default a dozen, from the first non-constant one to the last.
    off_screen
        Whether to render without a window. A notebook shows the plot either way.

    Returns
    -------
    pyvista.Plotter
        ``show()`` shows it, ``screenshot(path)`` saves it, ``close()`` frees it.

    Raises
    ------
    ArrayError
        When an array of the mesh has the wrong shape or type, or the harmonics belong to a mesh
        with another number of vertices.
    OptionError
        When one of `indices` is not in the basis.
    MissingPackageError
        When PyVista (extra `render`) is not installed.

    Examples
    --------
    >>> plot_harmonics(V, F, manifold_harmonics(V, F), [1, 2, 3, 10]).show()
    """
    check_class(harmonics, Harmonics, "manifold_harmonics")
    V, F = mesh_arrays(mesh_or_vertices, faces)
    if len(harmonics.masses) != len(V):
        raise ArrayError(
            f"the harmonics are of a mesh of {len(harmonics.masses)} vertices, not of {len(V)}: "
            "pass those of this mesh"
        )
    panels = _panels(harmonics, V, F, indices)
    frame = Frame.around([V], View.of_widest_side(V))
    columns = _columns(len(panels), frame)
    # Leave the height of the label above, too: the camera turns about the centre of the mesh.
    frame = replace(frame, height=frame.height + 2 * _LABEL_HEIGHT * frame.width / _PANEL_WIDTH)
    panel_size = (_PANEL_WIDTH, round(_PANEL_WIDTH * frame.height / frame.width))
    plotter = scene(panels, frame, columns, panel_size, font_size=8, off_screen=off_screen)
    plotter.link_views()
    return plotter


def _panels(
    basis: Harmonics, V: NDArray[np.float64], F: NDArray[Any], modes: Sequence[int] | None
) -> list[Panel]:
    """Colour a mesh by its harmonics."""
    size = len(basis.eigenvalues)
    if modes is None:
        constants = int(np.count_nonzero(basis.eigenvalues == 0))
        modes = spread_modes(min(constants, size - 1), size)
    check_modes(modes, size)
    diagonal = float(np.linalg.norm(np.ptp(V, axis=0)))
    return [
        Panel(
            f"harmonic {mode}\n{_wavelength(basis.frequencies[mode], diagonal)}",
            V,
            F,
            to_full_colours(basis.harmonics[:, mode], basis.masses),
        )
        for mode in map(index, modes)
    ]


def _columns(count: int, frame: Frame) -> int:
    return min(count, _COLUMNS if frame.width > 0.8 * frame.height else _COLUMNS_UPRIGHT)


def _wavelength(frequency: float, diagonal: float) -> str:
    """Format a wavelength like a feature size of the filter."""
    if frequency == 0:
        return "constant"
    return f"wavelength {100 * 2 * np.pi / (frequency * diagonal):.3g} %"
