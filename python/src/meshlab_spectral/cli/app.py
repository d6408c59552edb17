"""The command `meshlab-spectral` and its subcommands."""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Annotated

import typer

from meshlab_spectral.cli.command_line import AllCommands, OneCommand, with_verbosity
from meshlab_spectral.cli.messages import EXIT_CODES, VERBOSITY

app = typer.Typer(
    cls=AllCommands,
    help="Denoise, smooth, sharpen and band-filter meshes by the size of their details.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
)


# What a result, or an error, may depend on.
_LIBRARIES = ("numpy", "pymeshlab", "nibabel", "pyvista", "vtk", "scipy", "matplotlib", "dask")


def _print_version(wanted: bool) -> None:
    if not wanted:
        return
    from importlib.metadata import PackageNotFoundError, version

    def of(package: str) -> str:
        try:
            return f"{package} {version(package)}"
        except PackageNotFoundError:
            return f"no {package}"

    typer.echo(f"{of('meshlab-spectral')}, {of('pymeshlab')}")
    if VERBOSITY.verbose:
        import platform

        from meshlab_spectral.plugin.versions import versions

        typer.echo(f"Python {platform.python_version()} on {platform.platform()}")
        typer.echo(f"core {versions()['core']}")
        typer.echo(", ".join(map(of, _LIBRARIES)))
    raise typer.Exit


def _print_manual(wanted: bool) -> None:
    if wanted:
        from meshlab_spectral.cli.man import manual

        typer.echo(manual(app))
        raise typer.Exit


def _be_verbose(wanted: bool) -> None:
    VERBOSITY.verbose = wanted


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, help="Print the version; with -v, all versions."
        ),
    ] = False,
    man: Annotated[
        bool,
        typer.Option(
            "--man", callback=_print_manual, help="Print the manual page, for `man -l -`."
        ),
    ] = False,
    # Read first, so that it has an effect on --version wherever it stands.
    verbose: Annotated[
        bool, typer.Option("-v", callback=_be_verbose, is_eager=True, hidden=True)
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
