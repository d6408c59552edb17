"""The command `meshlab-spectral` and its subcommands."""

from __future__ import annotations

from importlib.metadata import version
from typing import Annotated

import typer

from meshlab_spectral.cli.basis import BASIS_HELP, basis_command
from meshlab_spectral.cli.batch import BATCH_HELP, batch_command
from meshlab_spectral.cli.command_line import AllCommands, OneCommand, with_verbosity
from meshlab_spectral.cli.filter import (
    DENOISE_HELP,
    FILTER_HELP,
    denoise_command,
    filter_command,
)
from meshlab_spectral.cli.info import INFO_HELP, info_command
from meshlab_spectral.cli.install import INSTALL_HELP, install_command
from meshlab_spectral.cli.messages import EXIT_CODES
from meshlab_spectral.cli.spectra import SPECTRA_HELP, spectra_command
from meshlab_spectral.cli.spectrum import SPECTRUM_HELP, spectrum_command

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
        own, host = version("meshlab-spectral"), version("pymeshlab")
        typer.echo(f"meshlab-spectral {own}, pymeshlab {host}")
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


for _name, _help, _command in (
    ("info", INFO_HELP, info_command),
    ("denoise", DENOISE_HELP, denoise_command),
    ("filter", FILTER_HELP, filter_command),
    ("batch", BATCH_HELP, batch_command),
    ("spectrum", SPECTRUM_HELP, spectrum_command),
    ("spectra", SPECTRA_HELP, spectra_command),
    ("basis", BASIS_HELP, basis_command),
    ("install", INSTALL_HELP, install_command),
):
    app.command(_name, cls=OneCommand, help=_help, epilog=EXIT_CODES)(with_verbosity(_command))
