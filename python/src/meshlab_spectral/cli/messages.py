"""Messages of all commands: errors with their exit codes, and warnings."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import typer
from rich.console import Console

from meshlab_spectral.cli.interrupts import EXIT_INTERRUPTED, raise_interrupts
from meshlab_spectral.errors import FormatError, InputError, OptionError, SpectralError
from meshlab_spectral.files.formats import POINTS_ONLY

EXIT_FAILED, EXIT_USAGE = 1, 2

EXIT_CODES = (
    "Exit codes: 0 all done; 1 a file could not be read, filtered or written; 2 invalid command "
    "line; 130 interrupted."
)

MESSAGES = Console(stderr=True)


@contextlib.contextmanager
def errors_reported(debug: bool, when_interrupted: str = "no output was written") -> Iterator[None]:
    """Turn any error of this package into a message and an exit code."""
    try:
        raise_interrupts()
        yield
    except KeyboardInterrupt:
        MESSAGES.print(f"Interrupted: {when_interrupted}.")
        raise typer.Exit(EXIT_INTERRUPTED) from None
    except SpectralError as error:
        if debug:
            MESSAGES.print_exception()
        # No markup or wrapping: file names may contain brackets, and scripts parse messages.
        MESSAGES.print(f"Error: {error}", markup=False, highlight=False, soft_wrap=True)
        usage = isinstance(error, OptionError | FormatError | InputError)
        raise typer.Exit(EXIT_USAGE if usage else EXIT_FAILED) from error


def warn_of_points_only(ending: str) -> None:
    """Warn of a format, such as .xyz, in which MeshLab silently drops the faces."""
    plain = ending.removeprefix(".")
    if plain.lower() in POINTS_ONLY:
        MESSAGES.print(
            f"Warning: .{plain} files hold points only, the faces are not written.",
            highlight=False,
            soft_wrap=True,
        )
