"""Figure 5: the fractional powers of two filters, and the shapes they produce.

For a low-pass and a band enhancement: the powers F^(i/K) as a family of curves, next to the shapes
after some of the K steps, with the basis of the input throughout and with the basis recomputed
after each step (Kovnatsky et al. 2012, Figure 5).
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
from meshlab_spectral.filters.options import BasisUpdate, FilterOptions
from meshlab_spectral.filters.transfer import gain
from stability import BAND, LOW_PASS
from subject import Subject

if TYPE_CHECKING:
    from matplotlib.axes import Axes

K = 10
SHOWN = (3, 6, 10)
RECORDED = (3, 10)  # the others are between these
# The update that copes best with each filter.
ROWS: list[tuple[FilterOptions, BasisUpdate]] = [
    (LOW_PASS, "none"),
    (LOW_PASS, "conformal"),
    (BAND, "none"),
    (BAND, "full"),
]
_ROW_NAMES = {"none": "no update", "full": "full update", "conformal": "conformal update"}


def after(options: FilterOptions, i: int, update: BasisUpdate) -> FilterOptions:
    """Options for the first i of K steps of a filter: i steps of F^(1/K), or F^(i/K)."""
    # With a single basis all powers commute: one step equals i steps.
    steps = 1 if update == "none" else i
    return replace(options, power=i / K, steps=steps, basis_update=update)


def figure(subject: Subject, scale: float = 1.0) -> Drawing:
    """Compute the figure for one mesh."""
    numbers: Numbers = {}
    for options, update in ROWS:
        for i in RECORDED:
            name = f"{filter_name(options)}, power {i / K:g}, {_ROW_NAMES[update]}"
            numbers |= labelled(name, subject.displacement(after(options, i, update)))
    return Drawing(numbers, functools.partial(_draw, subject, scale))


def _draw(subject: Subject, scale: float, path: Path) -> None:
    shapes = {
        (row, i): subject.filtered(after(options, i, update))
        for row, (options, update) in enumerate(ROWS)
        for i in SHOWN
    }
    frames = Frame.row_by_row(
        [[subject.V, *(shapes[row, i] for i in SHOWN)] for row in range(len(ROWS))], subject.view
    )
    sheet = Sheet([frame.width / frame.height for frame in frames], 1 + len(SHOWN), 1, scale)
    for row, (options, update) in enumerate(ROWS):
        if row % 2:
            original = render(Panel("", subject.V, subject.F), frames[row], sheet.pixels)
            sheet.picture(row, 0, original, "power 0: original")
        else:
            _plot_powers(sheet.plot(row, 0), options)
        for column, i in enumerate(SHOWN, start=1):
            image = render(Panel("", shapes[row, i], subject.F), frames[row], sheet.pixels)
            sheet.picture(row, column, image, f"power {i / K:g}, {_ROW_NAMES[update]}")
    sheet.save(path)


def _plot_powers(axes: Axes, options: FilterOptions) -> None:
    """Plot F^(i/K) against frequency for all i, thick where the shape is shown."""
    from matplotlib import colormaps

    x = np.linspace(0, 3, 301)
    for i in range(K + 1):
        shown = i in SHOWN or i == 0
        gains = gain(replace(options, power=i / K), x) if i else np.ones_like(x)
        axes.plot(
            x,
            gains,
            color=colormaps["viridis_r"](0.15 + 0.8 * i / K),
            linewidth=1.6 if shown else 0.6,
            label=f"{i / K:g}" if shown else None,
        )
    axes.set_xlim(0, 3)
    axes.set_ylim(0, 1.1 * max(1.0, options.pass_gain))
    axes.set_xticks([0, 1, 2, 3])
    axes.set_xlabel(r"frequency $\omega / \omega_c$", fontsize=FONT_SIZE - 1, color=INK)
    axes.set_ylabel("gain", fontsize=FONT_SIZE - 1, color=INK)
    axes.set_title(filter_name(options), fontsize=FONT_SIZE, color=INK, pad=3)
    axes.legend(
        title="power",
        title_fontsize=FONT_SIZE - 2,
        fontsize=FONT_SIZE - 2,
        loc="lower left" if options.pass_gain <= 1 else "upper right",
        frameon=False,
        handlelength=1.2,
        labelspacing=0.15,
        borderaxespad=0.1,
        labelcolor=INK,
    )
