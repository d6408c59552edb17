"""The command `meshlab-spectral` and its subcommands."""

from __future__ import annotations

from importlib.metadata import version
from typing import Annotated

import typer

from meshlab_spectral.cli.basis import BASIS_HELP, basis_command
from meshlab_spectral.cli.batch import BATCH_HELP, batch_command
from meshlab_spectral.cli.denoise import DENOISE_HELP, denoise_command
from meshlab_spectral.cli.figures import FIGURES_HELP, figures_command
from meshlab_spectral.cli.filter import FILTER_HELP, filter_command
from meshlab_spectral.cli.install import INSTALL_HELP, install_command
from meshlab_spectral.cli.messages import EXIT_CODES
from meshlab_spectral.cli.spectra import SPECTRA_HELP, spectra_command
from meshlab_spectral.cli.spectrum import SPECTRUM_HELP, spectrum_command

app = typer.Typer(
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


app.command("filter", help=FILTER_HELP, epilog=EXIT_CODES)(filter_command)
app.command("denoise", help=DENOISE_HELP, epilog=EXIT_CODES)(denoise_command)
app.command("batch", help=BATCH_HELP, epilog=EXIT_CODES)(batch_command)
app.command("spectrum", help=SPECTRUM_HELP, epilog=EXIT_CODES)(spectrum_command)
app.command("spectra", help=SPECTRA_HELP, epilog=EXIT_CODES)(spectra_command)
app.command("basis", help=BASIS_HELP, epilog=EXIT_CODES)(basis_command)
app.command("figures", help=FIGURES_HELP, epilog=EXIT_CODES)(figures_command)
app.command("install", help=INSTALL_HELP, epilog=EXIT_CODES)(install_command)
