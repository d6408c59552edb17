"""Matplotlib figures that a notebook shows as the value of a cell."""

from __future__ import annotations

import io

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure


class NotebookFigure(Figure):
    """A figure that is not registered with pyplot, and needs no ``%matplotlib inline``."""

    canvas: FigureCanvasAgg

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png")
        return picture.getvalue()
