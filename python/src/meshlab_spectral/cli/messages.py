"""Output of all commands: results, warnings, and errors with their exit codes."""

from __future__ import annotations

import contextlib
import logging
import re
from collections.abc import Iterator
from dataclasses import dataclass

import typer
from rich.console import Console
from rich.table import Table

from meshlab_spectral.cli.interrupts import EXIT_INTERRUPTED, raise_interrupts
from meshlab_spectral.errors import FormatError, InputError, OptionError, SpectralError
from meshlab_spectral.files.extensions import POINTS_ONLY
from meshlab_spectral.formats.names import visible
from meshlab_spectral.workers.process import LOG

EXIT_FAILED, EXIT_USAGE = 1, 2
_LONGEST = 5000  # characters of a message: two paths of Linux' 4,096 and more are rare

EXIT_CODES = (
    "Exit codes: 0 all done; 1 a file could not be read, filtered or written; 2 invalid command "
    "line, or an option that does not suit the mesh; 130 interrupted."
)

# Transfer functions and file names may contain ":x:", which is not an emoji.
MESSAGES = Console(stderr=True, emoji=False)


@dataclass
class Verbosity:
    """How much the command of this process prints: --quiet, --verbose, --debug."""

    quiet: bool = False
    verbose: bool = False
    debug: bool = False


VERBOSITY = Verbosity()


class _LogHandler(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        """Print a line of MeshLab's log, above a progress bar if there is one."""
        print_message(record.getMessage())


@contextlib.contextmanager
def errors_reported(when_interrupted: str = "no output was written") -> Iterator[None]:
    """Turn any error of this package into a message and an exit code."""
    if VERBOSITY.verbose:
        LOG.addHandler(_LogHandler())
        LOG.setLevel(logging.INFO)
    try:
        raise_interrupts()
        yield
    except KeyboardInterrupt:
        MESSAGES.print(f"Interrupted: {when_interrupted}.")
        raise typer.Exit(EXIT_INTERRUPTED) from None
    except SpectralError as error:
        if VERBOSITY.debug:
            MESSAGES.print_exception()
        print_error(in_shell(error))
        usage = isinstance(error, OptionError | FormatError | InputError)
        raise typer.Exit(EXIT_USAGE if usage else EXIT_FAILED) from error


def in_shell(error: SpectralError) -> str:
    """Name options that an error begins with as a shell does."""
    if not isinstance(error, OptionError):
        return str(error)
    options, colon, text = str(error).partition(": ")
    # In small letters: a variable of the environment keeps its name.
    flags = re.sub(r"(?<![^ ])([a-z]\w*) = ", lambda name: flag(name[1]) + " ", options)
    return flags + colon + text


def flag(name: str) -> str:
    """Return an option as a shell has it."""
    return "--" + name.replace("_", "-")


def print_result(result: Table | object) -> None:
    """Print a table or a line on standard output, unless --quiet."""
    if VERBOSITY.quiet:
        return
    if isinstance(result, Table):
        Console(emoji=False).print(result)
    else:
        typer.echo(one_line(str(result)))


def print_message(text: str) -> None:
    """Print a line on standard error."""
    # No markup or wrapping: file names may contain brackets, and scripts parse messages.
    MESSAGES.print(one_line(text), markup=False, highlight=False, soft_wrap=True)


def one_line(text: str) -> str:
    """Return a text as one line that a terminal prints, and does not obey."""
    line = visible(text)
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 900]} ... {line[-900:]}"


def print_error(text: str) -> None:
    """Print an error."""
    print_message(f"Error: {text}")


def print_warning(text: str) -> None:
    """Print a warning, even with --quiet."""
    print_message(f"Warning: {text}.")


def warn_of_points_only(ending: str) -> None:
    """Warn about a format, such as .xyz, in which MeshLab silently drops the faces."""
    plain = ending.removeprefix(".")
    if plain.lower() in POINTS_ONLY:
        print_warning(f".{plain} files hold only points; the faces are not written")
