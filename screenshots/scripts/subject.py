"""The mesh of a figure, and the results of filters on it."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
from figure_numbers import Numbers, diagonal, displacement
from meshlab_spectral import FilterOptions, filter_mesh, measure_artefacts
from meshlab_spectral.figures.pictures import View
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.filters.arrays import mean_edge
from meshlab_spectral.filters.artefacts import Artefacts
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
    diagonal
        Diagonal of the bounding box.
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
        self.diagonal = diagonal(self.V)
        self.view = View.of_widest_side(self.V)
        self._shapes: dict[FilterOptions, Shape] = {}
        self._artefacts: dict[FilterOptions, Artefacts] = {}

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

    def displacement(self, options: FilterOptions) -> Numbers:
        """Measure how far a filter moves the mesh."""
        return displacement(self.V, self.F, self.filtered(options))

    def artefacts(self, options: FilterOptions) -> Artefacts:
        """Measure the artefacts that a filter leaves, above twice its own cutoff."""
        if options not in self._artefacts:
            edge = mean_edge(self.V, self.F)
            size = options.sizes(self.diagonal, edge, self.diagonal)["feature_size"]
            self._artefacts[options] = measure_artefacts(self.filtered(options), self.F, size)
        return self._artefacts[options]

    def artefact_numbers(self, options: FilterOptions) -> Numbers:
        """Return the size of these artefacts, in percent of the diagonal before the filter."""
        left, percent = self.artefacts(options), 100 / self.diagonal
        return {
            "rms artefact, %": percent * left.rms,
            "largest artefact, %": percent * left.maximum,
        }


@functools.cache
def subject_of(source: Path) -> Subject:
    """Return the subject of a file, the same for all figures."""
    return Subject(source)


def scheme_name(options: FilterOptions) -> str:
    """Describe how a filter is applied: `one shot`, `10 steps, full update`."""
    if options.steps == 1:
        return "one shot"
    return f"{options.steps} steps, {options.basis_update} update"
