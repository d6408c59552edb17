"""Pages of labelled pictures in rows and columns; lengths in inches."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from meshlab_spectral.extras import check_extras
from meshlab_spectral.figures.pictures import SIGNED_COLOURS, Image
from meshlab_spectral.files.whole_files import writing_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK = "#202020"
FONT_SIZE = 9.0

# Width of a page: scaled to 900 pixels on a web page, its letters are 12 pixels high.
_PAGE_WIDTH = 9.0
# Pixels per page, about 1 MB as PNG to suit a repository, and dots per inch.
_PAGE_PIXELS = 1.9e6
_DOTS_PER_INCH = 200
_LINE = 0.165
_GAP = 0.07
# Limits the height of pictures of upright shapes, and thus their width.
_MAX_HEIGHT = 3.4
# Width of the longest labels; narrower pictures are centred in their cells.
_MIN_CELL = 1.95


class Sheet:
    """A page of pictures, all of the same width: `pixels`. A notebook shows its `figure`.

    Of each row, `aspects` has width / height of its pictures, under each of which is a label of so
    many lines. A `scale` of 1 fills a screen; a `footer` is a strip at the bottom of the page, for
    `colour_bar`. Raises MissingPackageError when Matplotlib is not installed.
    """

    def __init__(
        self,
        aspects: Sequence[float],
        columns: int,
        label_lines: int,
        scale: float = 1.0,
        footer: float = 0.0,
    ) -> None:
        check_extras("plots")
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        from meshlab_spectral.figures.notebook import NotebookFigure

        fitting = (_PAGE_WIDTH - (columns + 1) * _GAP) / columns
        self._picture = min(fitting, min(aspects) * _MAX_HEIGHT)
        self._cell = max(self._picture, min(fitting, _MIN_CELL))
        self._heights = [self._picture / aspect for aspect in aspects]
        self._label = label_lines * _LINE + 0.06
        self._width = columns * (self._cell + _GAP) + _GAP
        self._height = sum(self._heights) + len(aspects) * (self._label + _GAP) + _GAP + footer
        area = self._width * self._height
        self._dpi = scale * min(_DOTS_PER_INCH, (_PAGE_PIXELS / area) ** 0.5)
        self.pixels = round(self._picture * self._dpi)
        size = (self._width, self._height)
        self.figure = NotebookFigure(size, dpi=self._dpi, facecolor="white")
        self._canvas = FigureCanvasAgg(self.figure)

    def picture(self, row: int, column: int, image: Image, label: str, colour: str = INK) -> None:
        """Fill a cell with a picture and the label under it."""
        left, bottom = self._left(column), self._bottom(row)
        margin = (self._cell - self._picture) / 2
        axes = self._axes(left + margin, bottom, self._picture, self._heights[row])
        axes.imshow(image, aspect="auto", interpolation="antialiased")
        axes.set_axis_off()
        self.figure.text(
            (left + self._cell / 2) / self._width,
            (bottom - 0.03) / self._height,
            label,
            ha="center",
            va="top",
            fontsize=FONT_SIZE,
            color=colour,
        )

    def plot(self, row: int, column: int) -> Axes:
        """Add axes for curves to a cell: full width, and not much higher than wide."""
        left, below, right, above = 0.44, 0.34, 0.1, 0.2
        width = self._cell - left - right
        room = self._heights[row] + self._label - below - above
        height = min(room, 1.1 * width)
        bottom = self._bottom(row) - self._label + below + (room - height) / 2
        axes = self._axes(self._left(column) + left, bottom, width, height)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        axes.tick_params(labelsize=FONT_SIZE - 1, colors=INK, length=2.5, pad=2)
        return axes

    def colour_bar(
        self, labels: tuple[str, str, str], caption: str = "", least: float = -1.0
    ) -> None:
        """Draw a colour bar in the footer, with labels at its left end, middle and right end.

        It shows the colours of values of panels from `least` to 1. A caption goes below it and
        needs one more line of footer.
        """
        width = min(2.4, 0.5 * self._width)
        bottom = 0.22 + (_LINE if caption else 0)
        axes = self._axes((self._width - width) / 2, bottom, width, 0.1)
        axes.set_xlabel(caption, fontsize=FONT_SIZE - 1, color=INK, labelpad=2)
        values = np.linspace(least, 1, 256)[None]
        axes.imshow(values, aspect="auto", cmap=SIGNED_COLOURS, vmin=-1, vmax=1)
        axes.set_yticks([])
        axes.set_xticks([0, 127.5, 255], labels)
        axes.tick_params(labelsize=FONT_SIZE - 1, colors=INK, length=0, pad=3)
        for spine in axes.spines.values():
            spine.set_visible(False)

    def save(self, path: Path) -> None:
        """Write the page, atomically; raise MeshFileError when it cannot be written."""
        from PIL import Image as Picture

        self._canvas.draw()
        # No alpha channel and best compression: a third smaller.
        picture = Picture.fromarray(np.asarray(self._canvas.buffer_rgba())[:, :, :3])
        with writing_whole(path) as scratch:
            picture.save(scratch, optimize=True, dpi=(self._dpi, self._dpi))

    def _left(self, column: int) -> float:
        return _GAP + column * (self._cell + _GAP)

    def _bottom(self, row: int) -> float:
        """Bottom edge of a row's pictures; their labels are below it."""
        rows = row + 1
        return self._height - sum(self._heights[:rows]) - row * self._label - rows * _GAP

    def _axes(self, left: float, bottom: float, width: float, height: float) -> Axes:
        rectangle = (
            left / self._width,
            bottom / self._height,
            width / self._width,
            height / self._height,
        )
        axes: Axes = self.figure.add_axes(rectangle)
        return axes
