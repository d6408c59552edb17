"""Figure 1: a strong filter in one shot damages thin parts; fractional steps do not.

A low-pass and a band enhancement, each in one shot, in ten steps of the paper's scheme, and in ten
steps with the conformal update (Kovnatsky et al. 2012, Figure 1).
"""

from __future__ import annotations

import functools
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from figure_numbers import Drawing, Numbers, labelled
from meshlab_spectral.figures.pictures import Frame, Panel, render
from meshlab_spectral.figures.sheet import FONT_SIZE, INK, Sheet
from meshlab_spectral.figures.spectrum import filter_name
from meshlab_spectral.filters.option_types import Length
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.transfer import gain
from subject import Subject, scheme_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LOW_PASS = FilterOptions(feature_size=Length(15, "%"))
BAND = FilterOptions(
    filter_type="band-pass", feature_size=Length(15, "%"), stop_gain=1, pass_gain=4
)
COLOURS = {LOW_PASS.filter_type: "#1c639f", BAND.filter_type: "#b04607"}


def schemes(options: FilterOptions) -> list[FilterOptions]:
    """Options for a filter in one shot, and in ten steps with either update."""
    return [
        replace(options, steps=1, basis_update="none"),
        replace(options, steps=10, basis_update="full"),
        replace(options, steps=10, basis_update="conformal"),
    ]


def figure(subject: Subject, scale: float = 1.0) -> Drawing:
    """Compute the figure for one mesh."""
    numbers: Numbers = {}
    for options in [*schemes(LOW_PASS), *schemes(BAND)]:
        name = f"{filter_name(options)}, {scheme_name(options)}"
        numbers |= labelled(name, subject.displacement(options))
        if options.filter_type == LOW_PASS.filter_type:  # after the other, small details are shape
            numbers |= labelled(name, subject.artefact_numbers(options))
    return Drawing(numbers, functools.partial(_draw, subject, scale))


def _draw(subject: Subject, scale: float, path: Path) -> None:
    rows = [schemes(LOW_PASS), schemes(BAND)]
    shapes = [[subject.filtered(options) for options in row] for row in rows]
    frames = Frame.row_by_row([[subject.V, *shapes[0]], *shapes[1:]], subject.view)
    sheet = Sheet([frame.width / frame.height for frame in frames], 1 + len(rows[0]), 2, scale)
    original = render(Panel("", subject.V, subject.F), frames[0], sheet.pixels)
    sheet.picture(0, 0, original, "original")
    for i, row in enumerate(rows):
        for j, options in enumerate(row):
            picture = render(Panel("", shapes[i][j], subject.F), frames[i], sheet.pixels)
            label = f"{filter_name(options)}\n{scheme_name(options)}"
            sheet.picture(i, 1 + j, picture, label, COLOURS[options.filter_type])
    _plot_gains(sheet.plot(1, 0))
    sheet.save(path)


def _plot_gains(axes: Axes) -> None:
    """Plot the gains of both filters by feature size, large ones on the left."""
    sizes = np.geomspace(200, 2, 400)
    for options, place in ((LOW_PASS, (180, 0.6)), (BAND, (180, 4.35))):
        colour = COLOURS[options.filter_type]
        gains = gain(options, options.feature_size.value / sizes)
        axes.plot(sizes, gains, color=colour, linewidth=1.5)
        axes.text(*place, filter_name(options), fontsize=FONT_SIZE - 1, color=colour, va="center")
    axes.set_xscale("log")
    axes.set_xlim(sizes[0], sizes[-1])
    axes.set_ylim(0, 4.6)
    axes.set_xticks([100, 30, 10, 3], ["100", "30", "10", "3"])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("feature size, % of the diagonal", fontsize=FONT_SIZE - 1, color=INK)
    axes.set_ylabel("gain", fontsize=FONT_SIZE - 1, color=INK)
