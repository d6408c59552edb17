"""Spectral Filter (Fractional) for MeshLab 2025.07: for pymeshlab and the shell.

>>> import pymeshlab, meshlab_spectral
>>> meshlab_spectral.load()
>>> ms = pymeshlab.MeshSet()
>>> ms.load_new_mesh("scan.ply")
>>> ms.apply_coord_spectral_filter_fractional(feature_size=pymeshlab.PercentageValue(2))

Each subpackage imports only from those to its left; all of them import `errors`
and `extras`:

    plugin <- filters <- files <- process <- figures, batch <- cli
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from meshlab_spectral.batch.files import filter_files
    from meshlab_spectral.batch.jobs import FileResult
    from meshlab_spectral.errors import (
        BatchError,
        FilterError,
        FormatError,
        InputError,
        MeshFileError,
        MissingPackageError,
        OptionError,
        PluginError,
        SpectralError,
    )
    from meshlab_spectral.figures.harmonics import plot_harmonics
    from meshlab_spectral.figures.spectrum import plot_spectrum
    from meshlab_spectral.filters.artefacts import Artefacts, measure_artefacts
    from meshlab_spectral.filters.denoise import DenoiseOptions, denoise_mesh
    from meshlab_spectral.filters.fractional import filter_mesh
    from meshlab_spectral.filters.harmonics import Harmonics, manifold_harmonics, shape_dna
    from meshlab_spectral.filters.option_types import Length
    from meshlab_spectral.filters.options import FilterOptions
    from meshlab_spectral.filters.signals import filter_colors, filter_scalars
    from meshlab_spectral.filters.spectrum import GeometrySpectrum, geometry_spectrum
    from meshlab_spectral.plugin.loading import load
    from meshlab_spectral.plugin.memory import set_memory_limit
    from meshlab_spectral.plugin.threads import set_threads, threads

__all__ = [
    "Artefacts",
    "BatchError",
    "DenoiseOptions",
    "FileResult",
    "FilterError",
    "FilterOptions",
    "FormatError",
    "GeometrySpectrum",
    "Harmonics",
    "InputError",
    "Length",
    "MeshFileError",
    "MissingPackageError",
    "OptionError",
    "PluginError",
    "SpectralError",
    "denoise_mesh",
    "filter_colors",
    "filter_files",
    "filter_mesh",
    "filter_scalars",
    "geometry_spectrum",
    "load",
    "manifold_harmonics",
    "measure_artefacts",
    "plot_harmonics",
    "plot_spectrum",
    "set_memory_limit",
    "set_threads",
    "shape_dna",
    "threads",
]
# Imported when first used: the command must not wait for them before it can handle Ctrl-C.
_MODULES = {
    "Artefacts": "filters.artefacts",
    "BatchError": "errors",
    "DenoiseOptions": "filters.denoise",
    "FileResult": "batch.jobs",
    "FilterError": "errors",
    "FilterOptions": "filters.options",
    "FormatError": "errors",
    "GeometrySpectrum": "filters.spectrum",
    "Harmonics": "filters.harmonics",
    "InputError": "errors",
    "Length": "filters.option_types",
    "MeshFileError": "errors",
    "MissingPackageError": "errors",
    "OptionError": "errors",
    "PluginError": "errors",
    "SpectralError": "errors",
    "denoise_mesh": "filters.denoise",
    "filter_colors": "filters.signals",
    "filter_files": "batch.files",
    "filter_mesh": "filters.fractional",
    "filter_scalars": "filters.signals",
    "geometry_spectrum": "filters.spectrum",
    "load": "plugin.loading",
    "manifold_harmonics": "filters.harmonics",
    "measure_artefacts": "filters.artefacts",
    "plot_harmonics": "figures.harmonics",
    "plot_spectrum": "figures.spectrum",
    "set_memory_limit": "plugin.memory",
    "set_threads": "plugin.threads",
    "shape_dna": "filters.harmonics",
    "threads": "plugin.threads",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("meshlab-spectral")
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__, "__version__"]
