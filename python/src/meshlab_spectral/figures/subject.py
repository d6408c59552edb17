"""The mesh of a figure, and the results of filters on it."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.figures.pictures import View
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.process.single_file import filter_file_in_child

Shape = NDArray[np.float64]


class Subject:
    """A mesh file. Each filter runs once, however many figures show its result.

    Parameters
    ----------
    source
        A file that pymeshlab can read.
    on_stage
        Called with a description of each stage, to show to the user.

    Attributes
    ----------
    source, name
        The file; its name without extension.
    V, F
        n x 3 coordinates, m x 3 indices of the corners of triangles.
    view
        Viewpoint of the figures.

    Raises
    ------
    MeshFileError
        When the file cannot be read.
    """

    def __init__(self, source: Path, on_stage: Callable[[str], None] = lambda stage: None) -> None:
        self.source, self.name = source, source.stem
        self.V, self.F = load_arrays(source)
        self.view = View.of_widest_side(self.V)
        self._on_stage = on_stage
        self._shapes: dict[FilterOptions, Shape] = {}

    def stage(self, what: str) -> None:
        """Report a stage of the work on this mesh."""
        self._on_stage(f"{self.name}: {what}")

    def filtered(self, options: FilterOptions) -> Shape:
        """Return the coordinates after a filter.

        Raises
        ------
        FilterError
            When the filter rejects the mesh.
        """
        if options not in self._shapes:
            self.stage(describe(options))
            with tempfile.TemporaryDirectory() as folder:
                result = Path(folder) / "filtered.ply"
                filter_file_in_child(self.source, result, options)
                self._shapes[options], _ = load_arrays(result)
        return self._shapes[options]


def describe(options: FilterOptions) -> str:
    """Describe a filter and its scheme: `low-pass 15 %, 10 steps, full update`."""
    return f"{filter_name(options)}, {scheme_name(options)}"


def filter_name(options: FilterOptions) -> str:
    """Describe a filter: `low-pass 15 %`."""
    if options.filter_type == "custom":
        return f"custom {options.transfer_function}"
    size = str(options.feature_size).replace("%", " %")
    name = f"{options.filter_type} {size}"
    if options.stop_gain == 1:
        name = f"{options.filter_type} \N{MULTIPLICATION SIGN} {options.pass_gain:g} at {size}"
    return name if options.power == 1 else f"{name}, power {options.power:g}"


def scheme_name(options: FilterOptions) -> str:
    """Describe how a filter is applied: `one shot`, `10 steps, full update`."""
    if options.steps == 1:
        return "one shot"
    if options.basis_update == "none":
        return "no update"
    return f"{options.steps} steps, {options.basis_update} update"
