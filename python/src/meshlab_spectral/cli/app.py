"""The command `meshlab-spectral` and its subcommands."""

from __future__ import annotations

from importlib.metadata import version
from typing import Annotated

import typer

from meshlab_spectral.cli.basis import basis_command
from meshlab_spectral.cli.batch import batch_command
from meshlab_spectral.cli.command_line import AllCommands, Command, OneCommand, with_verbosity
from meshlab_spectral.cli.filter import denoise_command, filter_command
from meshlab_spectral.cli.info import info_command
from meshlab_spectral.cli.install import install_command
from meshlab_spectral.cli.messages import EXIT_CODES
from meshlab_spectral.cli.spectra import spectra_command
from meshlab_spectral.cli.spectrum import spectrum_command

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


_COMMANDS: dict[str, Command] = {
    "info": info_command,
    "denoise": denoise_command,
    "filter": filter_command,
    "batch": batch_command,
    "spectrum": spectrum_command,
    "spectra": spectra_command,
    "basis": basis_command,
    "install": install_command,
}
for _name, _command in _COMMANDS.items():
    app.command(_name, cls=OneCommand, epilog=EXIT_CODES)(with_verbosity(_command))
