"""Figure 4: a weak fractional power hardly changes the eigenfunctions; the whole filter does.

Eigenfunctions of the Laplacian (manifold harmonics) of the input, of the shape after the tenth
power of a low-pass, and of the shape after the whole low-pass in one shot (Kovnatsky et al. 2012,
Figure 4). This is why the filter takes weak steps: the basis remains valid within each of them.

A filter may reorder the eigenvalues. Each eigenfunction of the input is therefore shown next to the
most similar one of the filtered shape, with matching sign: the one with the largest correlation,
given in the label with its number. 1 is the same function, 0 an unrelated one.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from figure_numbers import Drawing, Numbers
from meshlab_spectral.figures.pictures import Frame, Panel, render, to_full_colours
from meshlab_spectral.figures.sheet import Sheet
from meshlab_spectral.figures.spectrum import filter_name
from meshlab_spectral.filters.arrays import lumped_areas
from meshlab_spectral.filters.harmonics import manifold_harmonics
from meshlab_spectral.filters.options import FilterOptions
from numpy.typing import NDArray
from stability import LOW_PASS
from subject import Subject

Array = NDArray[np.float64]

SHOWN = (5, 10, 20)
# More than shown, to find eigenfunctions whose eigenvalues the filter has reordered.
BASIS_SIZE = 40
TENTH = replace(LOW_PASS, steps=1, basis_update="none", power=0.1)
WHOLE = replace(TENTH, power=1.0)
COLUMNS: dict[str, FilterOptions | None] = {
    "input": None,
    f"1/10 power of {filter_name(LOW_PASS)}": TENTH,
    f"whole {filter_name(LOW_PASS)}": WHOLE,
}


def most_alike(phi: Array, Psi: Array, d: Array) -> tuple[int, float]:
    """Find the column of `Psi` most similar to `phi`, both on the same n vertices.

    Parameters
    ----------
    phi
        n values.
    Psi
        n x k values.
    d
        Areas of the n vertices, the weights of the correlation.

    Returns
    -------
    tuple of int and float
        Index of the column, and its correlation, -1 to 1.
    """
    lengths = np.sqrt((d @ phi**2) * (d @ Psi**2))
    correlation = (d * phi) @ Psi / lengths
    nearest = int(np.argmax(np.abs(correlation)))
    return nearest, float(correlation[nearest])


@dataclass(frozen=True)
class Match:
    """The eigenfunction of a shape that is most similar to one of the input.

    Attributes
    ----------
    mode
        The number of the input's.
    nearest
        The number of the shape's.
    correlation
        Their correlation, 0 to 1.
    values
        The shape's, n values, with the sign of the input's.
    """

    mode: int
    nearest: int
    correlation: float
    values: Array


def _matches(subject: Subject) -> dict[str, list[Match]]:
    """Compare the eigenfunctions of all columns with those of the first."""
    # If the mesh is too small even for the first one, the filter reports it.
    size = max(SHOWN[0] + 1, min(BASIS_SIZE, len(subject.V) - 1))
    d = lumped_areas(subject.V, subject.F)
    of_input: Array | None = None
    columns: dict[str, list[Match]] = {}
    for name, options in COLUMNS.items():
        Psi = manifold_harmonics(_shape(subject, options), subject.F, size).harmonics
        of_input = Psi if of_input is None else of_input
        columns[name] = []
        for mode in SHOWN:
            if mode < size:
                nearest, correlation = most_alike(of_input[:, mode], Psi, d)
                values = np.sign(correlation) * Psi[:, nearest]
                columns[name].append(Match(mode, nearest, abs(correlation), values))
    return columns


def _shape(subject: Subject, options: FilterOptions | None) -> Array:
    return subject.V if options is None else subject.filtered(options)


def figure(subject: Subject, scale: float = 1.0) -> Drawing:
    """Compute the figure for one mesh."""
    columns = _matches(subject)
    numbers: Numbers = {}
    for name in list(columns)[1:]:  # the input is the same as itself
        for match in columns[name]:
            label = f"{name}: harmonic {match.mode} of the input"
            numbers[f"{label}, most similar one"] = match.nearest
            numbers[f"{label}, correlation"] = match.correlation
    return Drawing(numbers, functools.partial(_draw, subject, columns, scale))


def _draw(subject: Subject, columns: dict[str, list[Match]], scale: float, path: Path) -> None:
    shapes = [_shape(subject, options) for options in COLUMNS.values()]
    rows = len(next(iter(columns.values())))
    frame = Frame.around(shapes, subject.view)
    sheet = Sheet([frame.width / frame.height] * rows, len(shapes), 2, scale, footer=0.4)
    d = lumped_areas(subject.V, subject.F)
    for column, ((name, matches), V) in enumerate(zip(columns.items(), shapes, strict=True)):
        for row, match in enumerate(matches):
            label = f"{name}\nharmonic {match.nearest}"
            if column > 0:
                label += f", correlation {match.correlation:.2f}"
            panel = Panel("", V, subject.F, to_full_colours(match.values, d))
            sheet.picture(row, column, render(panel, frame, sheet.pixels), label)
    sheet.colour_bar(("\N{MINUS SIGN}", "0", "+"))
    sheet.save(path)
