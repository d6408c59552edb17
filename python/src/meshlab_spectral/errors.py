"""The errors this package raises, by cause. Every message says how to fix it."""


class SpectralError(Exception):
    """Base class of all errors of this package."""


class PluginError(SpectralError):
    """The plugin or pymeshlab is missing, damaged or of the wrong version."""


class MissingPackageError(SpectralError):
    """A package of an extra is not installed."""


class OptionError(SpectralError, ValueError):
    """A filter option has an invalid value."""


class FormatError(SpectralError, ValueError):
    """An output file has an extension that cannot be written."""


class MeshFileError(SpectralError):
    """A mesh file cannot be read, or an output file cannot be written."""


class FilterError(SpectralError):
    """The filter rejected a mesh or failed on it."""


class ProcessDiedError(FilterError):
    """The process running MeshLab died without an answer."""


class TimeLimitError(FilterError):
    """A mesh took longer than its time limit."""


class MemoryLimitError(FilterError):
    """A mesh needed more than its memory limit."""


class InputError(SpectralError, ValueError):
    """A batch has unusable or conflicting inputs and outputs; nothing has been done."""


class BatchError(SpectralError):
    """A batch cannot run: its report or its workers are unavailable."""
