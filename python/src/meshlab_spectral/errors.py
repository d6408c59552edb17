"""The errors this package raises, by cause. Every message says how to fix it."""


class SpectralError(Exception):
    """Base class of all errors of this package."""


class PluginError(SpectralError):
    """The plugin or pymeshlab is missing, damaged or of the wrong version."""


class MissingPackageError(SpectralError):
    """A package of an extra is not installed."""


class FormatError(SpectralError, ValueError):
    """An output file has an extension that cannot be written."""


class MeshFileError(SpectralError):
    """A mesh file cannot be read, or an output file cannot be written.

    Attributes
    ----------
    code
        The cause. Of a file to read: "missing", "no_file" (a folder, a device), "no_access",
        "bad_name", "empty", "foreign" (of another format than its name says), "encoding" (UTF-16),
        "decimal_commas", "cut_off", "damaged", "bad_values" (coordinates that are not finite),
        "unsupported" (valid, with something that is not read), "unknown_format", "side_file" (it
        refers to a file that is missing, or outside its folder), "too_large" (it would grow beyond
        its budget of memory). Of one to write: "not_written", "disk_full".
    """

    def __init__(self, message: str, code: str = "") -> None:
        super().__init__(message)
        self.code = code


class ArrayError(SpectralError, ValueError):
    """An array passed to a function has the wrong shape, type or values."""


class ArgumentError(SpectralError, TypeError):
    """An argument is missing, or an object of the wrong kind, such as one that is no mesh."""


class UntiledError(MeshFileError):
    """A file or a filter cannot be handled in tiles; the message says why, and what to do."""


class FilterError(SpectralError):
    """The filter rejected a mesh or an option, or failed.

    Attributes
    ----------
    code
        The cause, such as "no_faces" or "out_of_memory"; empty if this package has found it.
    limit
        A number that goes with some causes, such as the largest basis size; else 0.
    """

    code = ""
    limit = 0


class OptionError(FilterError, ValueError):
    """A filter option has an invalid value, or one that does not suit the mesh."""


class MeshError(FilterError):
    """The mesh cannot be filtered: no faces, no area, coordinates that are not finite."""


class SolverError(FilterError):
    """A numerical method failed, or the filter would leave nothing of the shape."""


class Cancelled(SpectralError):  # noqa: N818 - nothing has gone wrong
    """The function `progress` of a call has returned False; nothing has changed."""

    code = "cancelled"
    limit = 0


class ProcessDiedError(FilterError):
    """The process running MeshLab died without an answer."""


class ProcessStartError(ProcessDiedError):
    """The process for MeshLab died before it was ready for a mesh."""


class TimeLimitError(FilterError):
    """A mesh took longer than its time limit."""


class MemoryLimitError(FilterError):
    """A mesh needs more memory than there is, or than its limit."""


class InputError(SpectralError, ValueError):
    """A batch has unusable or conflicting inputs and outputs; nothing has been done."""


class BatchError(SpectralError):
    """A batch cannot run: its report or its workers are unavailable."""
