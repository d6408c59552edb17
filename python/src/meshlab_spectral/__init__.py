"""Spectral Filter (Fractional) for MeshLab 2025.07: for pymeshlab and the shell.

>>> import pymeshlab, meshlab_spectral
>>> meshlab_spectral.load()
>>> ms = pymeshlab.MeshSet()
>>> ms.load_new_mesh("scan.ply")
>>> ms.apply_coord_spectral_filter_fractional(feature_size=pymeshlab.PercentageValue(2))

Each subpackage imports only from those to its left; all of them import `errors`:

    plugin <- filters <- files <- process <- figures, batch <- cli
"""

from importlib.metadata import version

from meshlab_spectral.batch.files import filter_files
from meshlab_spectral.batch.jobs import FileResult
from meshlab_spectral.errors import (
    BatchError,
    FilterError,
    InputError,
    MeshFileError,
    OptionError,
    PluginError,
)
from meshlab_spectral.filters.artefacts import Artefacts, measure_artefacts
from meshlab_spectral.filters.fractional import filter_mesh
from meshlab_spectral.filters.harmonics import Harmonics, manifold_harmonics
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.spectrum import GeometrySpectrum, geometry_spectrum
from meshlab_spectral.plugin.loading import load
from meshlab_spectral.plugin.threads import set_threads, threads

__all__ = [
    "Artefacts",
    "BatchError",
    "FileResult",
    "FilterError",
    "FilterOptions",
    "GeometrySpectrum",
    "Harmonics",
    "InputError",
    "MeshFileError",
    "OptionError",
    "PluginError",
    "filter_files",
    "filter_mesh",
    "geometry_spectrum",
    "load",
    "manifold_harmonics",
    "measure_artefacts",
    "set_threads",
    "threads",
]
__version__ = version("meshlab-spectral")
