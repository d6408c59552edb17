# What the package exports, for type checkers and for __init__.py.
from meshlab_spectral.batch.files import filter_files as filter_files
from meshlab_spectral.batch.jobs import FileResult as FileResult
from meshlab_spectral.errors import BatchError as BatchError
from meshlab_spectral.errors import FilterError as FilterError
from meshlab_spectral.errors import FormatError as FormatError
from meshlab_spectral.errors import InputError as InputError
from meshlab_spectral.errors import MeshFileError as MeshFileError
from meshlab_spectral.errors import MissingPackageError as MissingPackageError
from meshlab_spectral.errors import OptionError as OptionError
from meshlab_spectral.errors import PluginError as PluginError
from meshlab_spectral.errors import SpectralError as SpectralError
from meshlab_spectral.figures.harmonics import plot_harmonics as plot_harmonics
from meshlab_spectral.figures.spectrum import plot_spectrum as plot_spectrum
from meshlab_spectral.filters.artefacts import Artefacts as Artefacts
from meshlab_spectral.filters.artefacts import measure_artefacts as measure_artefacts
from meshlab_spectral.filters.denoise import DenoiseOptions as DenoiseOptions
from meshlab_spectral.filters.denoise import denoise_mesh as denoise_mesh
from meshlab_spectral.filters.fractional import filter_mesh as filter_mesh
from meshlab_spectral.filters.harmonics import Harmonics as Harmonics
from meshlab_spectral.filters.harmonics import manifold_harmonics as manifold_harmonics
from meshlab_spectral.filters.harmonics import shape_dna as shape_dna
from meshlab_spectral.filters.option_types import Length as Length
from meshlab_spectral.filters.options import FilterOptions as FilterOptions
from meshlab_spectral.filters.signals import filter_colors as filter_colors
from meshlab_spectral.filters.signals import filter_scalars as filter_scalars
from meshlab_spectral.filters.spectrum import GeometrySpectrum as GeometrySpectrum
from meshlab_spectral.filters.spectrum import geometry_spectrum as geometry_spectrum
from meshlab_spectral.plugin.limits import set_memory_limit as set_memory_limit
from meshlab_spectral.plugin.limits import set_threads as set_threads
from meshlab_spectral.plugin.limits import threads as threads
from meshlab_spectral.plugin.loading import load as load

__version__: str
