"""A sheet of a mesh's manifold harmonics, for `meshlab-spectral basis`."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import FormatError, OptionError
from meshlab_spectral.figures.pictures import (
    SIGNED_COLOURS,
    Frame,
    Panel,
    View,
    render,
    to_full_colours,
)
from meshlab_spectral.figures.sheet import Sheet
from meshlab_spectral.filters.harmonics import Harmonics

# Default number of pictures, and how many in a row.
_SHOWN = 12
_COLUMNS, _COLUMNS_UPRIGHT = 4, 6
# Colours compress worse than the other figures: this brings the file back to a megabyte.
_RESOLUTION = 0.92


def spread_modes(first: int, size: int) -> list[int]:
    """Choose harmonics from `first` to the last of `size`, geometrically spaced."""
    modes = [first]
    for ideal in np.geomspace(1, max(size - first, 1), _SHOWN)[1:]:
        modes.append(max(modes[-1] + 1, first - 1 + round(ideal)))
    return [mode for mode in modes if mode < size]


def check_modes(modes: Sequence[int], size: int) -> None:
    """Raise OptionError unless every mode is in a basis of `size` harmonics."""
    for mode in modes:
        if not 0 <= mode < size:
            raise OptionError(f"mode {mode}: a basis of {size} harmonics has modes 0 to {size - 1}")


def check_picture(path: Path) -> None:
    """Raise FormatError unless a picture is named .png."""
    if path.suffix != ".png":
        raise FormatError(f"{path.name}: the pictures are one PNG file, name it .png")


def draw_basis_file(
    archive: Path, path: Path, modes: Sequence[int] | None = None, scale: float = 1.0
) -> None:
    """Draw harmonics from an archive written by `meshlab-spectral basis`; see `draw`."""
    with np.load(archive) as arrays:
        basis = Harmonics(arrays["eigenvalues"], arrays["harmonics"], arrays["masses"])
        draw(basis, arrays["vertices"], arrays["faces"], path, modes, scale)


def draw(
    basis: Harmonics,
    V: NDArray[np.float64],
    F: NDArray[np.int64],
    path: Path,
    modes: Sequence[int] | None = None,
    scale: float = 1.0,
) -> None:
    """Draw harmonics to a .png file: red is positive, blue negative, a line marks zero.

    Parameters
    ----------
    basis
        Harmonics of the mesh V, F.
    V, F
        The mesh, n x 3 coordinates and m x 3 vertex indices.
    path
        The picture, written atomically.
    modes
        Harmonics to show; by default a dozen from the first non-constant one to the last.
    scale
        Resolution; 1 fills a screen.

    Raises
    ------
    OptionError
        When the basis has no such mode.
    MeshFileError
        When `path` cannot be written.
    """
    size = len(basis.eigenvalues)
    if modes is None:
        constants = int(np.count_nonzero(basis.eigenvalues == 0))
        modes = spread_modes(min(constants, size - 1), size)
    check_modes(modes, size)
    frame = Frame.around([V], View.of_widest_side(V))
    aspect = frame.width / frame.height
    columns = min(len(modes), _COLUMNS if aspect > 0.8 else _COLUMNS_UPRIGHT)
    rows = ceil(len(modes) / columns)
    sheet = Sheet([aspect] * rows, columns, 2, _RESOLUTION * scale, footer=0.56)
    diagonal = float(np.linalg.norm(np.ptp(V, axis=0)))
    for cell, mode in enumerate(modes):
        values = to_full_colours(basis.harmonics[:, mode], basis.masses)
        picture = render(Panel("", V, F, values), frame, sheet.pixels)
        label = f"harmonic {mode}\n{_wavelength(basis.frequencies[mode], diagonal)}"
        sheet.picture(*divmod(cell, columns), picture, label)
    sheet.colour_bar(
        SIGNED_COLOURS, ("\N{MINUS SIGN}", "0", "+"), "wavelengths in % of the model's diagonal"
    )
    sheet.save(path)


def _wavelength(frequency: float, diagonal: float) -> str:
    """Format a wavelength like a feature size of the filter."""
    if frequency == 0:
        return "constant"
    return f"wavelength {100 * 2 * np.pi / (frequency * diagonal):.3g} %"
