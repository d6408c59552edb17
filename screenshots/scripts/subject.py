"""The mesh of a figure, and the results of filters on it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from meshlab_spectral import FilterOptions, filter_mesh
from meshlab_spectral.figures.pictures import View
from meshlab_spectral.files.meshes import load_arrays
from numpy.typing import NDArray

Shape = NDArray[np.float64]


class Subject:
    """A mesh file. Each filter runs once, however many figures show its result.

    Attributes
    ----------
    name
        The file's name without extension.
    V, F
        n x 3 coordinates, m x 3 vertex indices of triangles.
    view
        Viewpoint of the figures.

    Raises
    ------
    MeshFileError
        When the file cannot be read.
    """

    def __init__(self, source: Path) -> None:
        self.name = source.stem
        self.V, self.F = load_arrays(source)
        self.view = View.of_widest_side(self.V)
        self._shapes: dict[FilterOptions, Shape] = {}

    def filtered(self, options: FilterOptions) -> Shape:
        """Return the coordinates after a filter.

        Raises
        ------
        FilterError
            When the filter rejects the mesh.
        """
        if options not in self._shapes:
            self._shapes[options], _ = filter_mesh(self.V, self.F, **options.as_dict())
        return self._shapes[options]


def scheme_name(options: FilterOptions) -> str:
    """Describe how a filter is applied: `one shot`, `10 steps, full update`."""
    if options.steps == 1:
        return "one shot"
    return f"{options.steps} steps, {options.basis_update} update"
