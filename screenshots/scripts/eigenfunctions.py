"""Figure 4: a weak fractional power hardly changes the eigenfunctions; the whole filter does.

Eigenfunctions of the Laplacian (manifold harmonics) of the input, of the shape after the tenth
power of a low-pass, and of the shape after the whole low-pass in one shot (Kovnatsky et al. 2012,
Figure 4). This is why the filter takes weak steps: the basis remains valid within each of them.

A filter may reorder the eigenvalues. Each eigenfunction of the input is therefore shown next to the
most similar one of the filtered shape, with matching sign: the one with the largest correlation,
given in the label with its number. 1 is the same function, 0 an unrelated one.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from meshlab_spectral.figures.pictures import SIGNED_COLOURS, Frame, Panel, render, to_full_colours
from meshlab_spectral.figures.sheet import Sheet
from meshlab_spectral.figures.spectrum import filter_name
from meshlab_spectral.filters.arrays import lumped_areas
from meshlab_spectral.filters.harmonics import manifold_harmonics
from numpy.typing import NDArray
from stability import LOW_PASS
from subject import Subject

Array = NDArray[np.float64]

SHOWN = (5, 10, 20)
# More than shown, to find eigenfunctions whose eigenvalues the filter has reordered.
BASIS_SIZE = 40
TENTH = replace(LOW_PASS, steps=1, basis_update="none", power=0.1)
WHOLE = replace(TENTH, power=1.0)
COLUMNS = {
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


def draw(subject: Subject, path: Path, scale: float = 1.0) -> None:
    """Draw the figure for one mesh into a .png file."""
    shapes = [subject.V if o is None else subject.filtered(o) for o in COLUMNS.values()]
    # If the mesh is too small even for the first one, the filter reports it.
    size = max(SHOWN[0] + 1, min(BASIS_SIZE, len(subject.V) - 1))
    shown = [mode for mode in SHOWN if mode < size]
    frame = Frame.around(shapes, subject.view)
    sheet = Sheet([frame.width / frame.height] * len(shown), len(shapes), 2, scale, footer=0.4)
    d = lumped_areas(subject.V, subject.F)
    of_input: Array | None = None
    for column, (name, V) in enumerate(zip(COLUMNS, shapes, strict=True)):
        Psi = manifold_harmonics(V, subject.F, size).harmonics
        of_input = Psi if of_input is None else of_input
        for row, mode in enumerate(shown):
            nearest, correlation = most_alike(of_input[:, mode], Psi, d)
            label = f"{name}\nharmonic {nearest}"
            if column > 0:
                label += f", correlation {abs(correlation):.2f}"
            values = np.sign(correlation) * Psi[:, nearest]
            picture = render(
                Panel("", V, subject.F, to_full_colours(values, d)), frame, sheet.pixels
            )
            sheet.picture(row, column, picture, label)
    sheet.colour_bar(SIGNED_COLOURS, ("\N{MINUS SIGN}", "0", "+"))
    sheet.save(path)
