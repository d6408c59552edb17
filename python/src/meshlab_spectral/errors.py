"""The errors that this package reports, by cause. Every message says how to mend it."""


class SpectralError(Exception):
    """Base of all errors that this package reports."""


class PluginError(SpectralError):
    """The plugin, or the pymeshlab that should load it, is missing or of the wrong version."""


class OptionError(SpectralError, ValueError):
    """An option of a filter has a value that it cannot take."""


class FormatError(SpectralError, ValueError):
    """The name of an output file ends in nothing that pymeshlab can write."""


class MeshFileError(SpectralError):
    """A mesh file cannot be read, or an output file cannot be written."""


class FilterError(SpectralError):
    """The filter refused a mesh, or failed on it."""
