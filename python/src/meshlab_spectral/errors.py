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


class ProcessDiedError(FilterError):
    """The process in which MeshLab worked on a mesh ended without an answer."""


class TimeLimitError(FilterError):
    """A mesh took more time than it was given."""


class MemoryLimitError(FilterError):
    """A mesh took more memory than it was given."""


class InputError(SpectralError, ValueError):
    """The inputs and outputs of a batch do not fit together: nothing has been done."""


class BatchError(SpectralError):
    """A batch cannot be run as a whole: its report or its workers are out of reach."""
