"""What is wanted of a mesh file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from meshlab_spectral.files.region import Region
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import FilterOptions


@dataclass(frozen=True)
class Request:
    """A mesh file, and what to do with it."""

    source: Path
    options: Options = FilterOptions()  # of a filter or a measurement
    mesh: str | None = None  # the name of the only mesh that counts; None: all
    region: Region = Region()  # what counts, in place of the selection of the file
    script: str | None = None  # the text of one of MeshLab, in place of the options
    verbose: bool = True  # whether the filter's report and MeshLab's log go to standard error
