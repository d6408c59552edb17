"""The command `meshlab-spectral` and its subcommands."""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Annotated

import typer

from meshlab_spectral.cli.command_line import AllCommands, OneCommand, with_verbosity
from meshlab_spectral.cli.messages import EXIT_CODES

app = typer.Typer(
    cls=AllCommands,
    help="Denoise, smooth, sharpen and band-filter meshes by the size of their details.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        try:
            host = f"pymeshlab {version('pymeshlab')}"
        except PackageNotFoundError:
            host = "no pymeshlab"
        typer.echo(f"meshlab-spectral {version('meshlab-spectral')}, {host}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Denoise, smooth, sharpen and band-filter meshes by the size of their details."""


# Name -> module.
_COMMANDS = {
    "info": "info",
    "denoise": "filter",
    "filter": "filter",
    "batch": "batch",
    "spectrum": "spectrum",
    "spectra": "spectra",
    "basis": "basis",
    "compare": "compare",
    "texture": "texture",
    "install": "install",
}
# Importing all of them would take longer than filtering a mesh.
_called = [word for word in sys.argv[1:2] if word in _COMMANDS]
for _name in _called or _COMMANDS:
    _module = import_module(f"meshlab_spectral.cli.{_COMMANDS[_name]}")
    _command = with_verbosity(getattr(_module, f"{_name}_command"))
    app.command(_name, cls=OneCommand, epilog=EXIT_CODES)(_command)
