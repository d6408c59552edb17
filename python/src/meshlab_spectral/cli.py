"""The command `meshlab-spectral`."""

from __future__ import annotations

import json
import signal
import time
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from meshlab_spectral import __version__
from meshlab_spectral.cli_basis import BASIS_HELP, basis_command
from meshlab_spectral.cli_batch import BATCH_HELP, batch_command
from meshlab_spectral.cli_install import INSTALL_HELP, install_command
from meshlab_spectral.cli_spectra import SPECTRA_HELP, spectra_command
from meshlab_spectral.cli_spectrum import SPECTRUM_HELP, spectrum_command
from meshlab_spectral.command_line import (
    EXIT_CODES,
    MESSAGES,
    errors_reported,
    progress_shown,
    warn_of_points_only,
    with_filter_options,
)
from meshlab_spectral.figures import FIGURES, draw_figures
from meshlab_spectral.options import FilterOptions
from meshlab_spectral.report import report_table, report_warnings
from meshlab_spectral.versions import versions
from meshlab_spectral.worker import filter_file_in_child

# "\b" keeps a paragraph's lines as they are.
_FILTER_HELP = """Filter one mesh by the size of its details.

\b
Smooth a scan, away with what is smaller than 1 % of it:
  meshlab-spectral filter scan.ply smooth.ply --feature-size 2%
Sharpen it:
  meshlab-spectral filter scan.ply sharp.ply --filter-type high-pass \\
    --stop-gain 1 --pass-gain 2
"""

_FIGURES_HELP = """Draw the figures of the paper (Kovnatsky et al. 2012) from your meshes.

\b
1  one shot of a strong filter, and ten fractional steps of it
4  eigenfunctions before a filter, after its 1/10 power, after all of it
5  the fractional powers of two filters, and the shapes that they make

Every mesh gets its own pictures. The paper's meshes, the dragon and the angel, are in the Stanford
3D Scanning Repository, https://graphics.stanford.edu/data/3Dscanrep/.

\b
  meshlab-spectral figures dragon.ply angel.ply --output pictures
  meshlab-spectral figures scan.ply --only 1,5
"""

app = typer.Typer(
    help="Smooth, sharpen and band-filter meshes by the size of their details.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def main() -> None:
    """Run the command line; ends the process with the exit code."""
    # A polite end (kill, a shutdown) tidies up like Ctrl-C does.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    app()


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"meshlab-spectral {__version__}, pymeshlab {version('pymeshlab')}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Tell the version."),
    ] = False,
) -> None:
    """Smooth, sharpen and band-filter meshes by the size of their details."""


@app.command("filter", help=_FILTER_HELP, epilog=EXIT_CODES)
@with_filter_options
def filter_command(
    options: FilterOptions,
    source: Annotated[
        Path, typer.Argument(metavar="INPUT", help="Mesh to read: .ply, .obj, .stl, .off, ...")
    ],
    target: Annotated[
        Path,
        typer.Argument(
            metavar="OUTPUT", help="Mesh to write; its ending says the format. Replaces a file."
        ),
    ],
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the report as one JSON object.")
    ] = False,
    debug: Annotated[bool, typer.Option("--debug", hidden=True)] = False,
) -> None:
    """Filter one mesh: `meshlab-spectral filter --help` tells how."""
    if target.exists() and source.exists() and target.samefile(source):
        raise typer.BadParameter(
            f"{target} is INPUT itself, and would be lost: choose another name", param_hint="OUTPUT"
        )
    begin = time.monotonic()
    with errors_reported(debug), progress_shown() as on_progress:
        report = filter_file_in_child(source, target, options, on_progress)
    warn_of_points_only(target.suffix)
    for warning in report_warnings(report):
        MESSAGES.print(f"Warning: {warning}.", highlight=False, soft_wrap=True)
    if as_json:
        typer.echo(json.dumps(_record(source, target, options, report, time.monotonic() - begin)))
    else:
        Console().print(report_table(report, f"{source.name} -> {target.name}"))


@app.command("figures", help=_FIGURES_HELP, epilog=EXIT_CODES)
def figures_command(
    meshes: Annotated[
        list[Path],
        typer.Argument(
            metavar="MESH",
            help="Meshes to show. They are seen along their shortest axis, with y up, or z.",
        ),
    ],
    output: Annotated[
        Path, typer.Option(metavar="DIR", help="Where to put the pictures; made if need be.")
    ] = Path(),
    only: Annotated[
        str, typer.Option(metavar="NUMBERS", help="The figures to draw, such as 1,5.")
    ] = ",".join(map(str, FIGURES)),
    scale: Annotated[
        float, typer.Option(min=0.1, max=10, help="Resolution: 2 has twice as many pixels a side.")
    ] = 1.0,
    debug: Annotated[bool, typer.Option("--debug", hidden=True)] = False,
) -> None:
    """Draw the figures of the paper: `meshlab-spectral figures --help` tells more."""
    numbers = _figure_numbers(only)
    interrupted = "pictures that were finished are there, and whole"
    with errors_reported(debug, interrupted), progress_shown() as on_progress:
        pictures = draw_figures(
            meshes, output, numbers, scale, lambda stage: on_progress(stage, None)
        )
    for picture in pictures:
        typer.echo(picture)


app.command("basis", help=BASIS_HELP, epilog=EXIT_CODES)(basis_command)
app.command("batch", help=BATCH_HELP, epilog=EXIT_CODES)(batch_command)
app.command("install", help=INSTALL_HELP, epilog=EXIT_CODES)(install_command)
app.command("spectra", help=SPECTRA_HELP, epilog=EXIT_CODES)(spectra_command)
app.command("spectrum", help=SPECTRUM_HELP, epilog=EXIT_CODES)(spectrum_command)


def _figure_numbers(text: str) -> list[int]:
    known = {str(number): number for number in FIGURES}
    numbers = [part.strip() for part in text.split(",")]
    if not known.keys() >= set(numbers):
        raise typer.BadParameter(f"{text!r}: choose of {', '.join(known)}", param_hint="--only")
    return [known[number] for number in numbers]


def _record(
    source: Path, target: Path, options: FilterOptions, report: dict[str, Any], seconds: float
) -> dict[str, Any]:
    return {
        "input": str(source),
        "output": str(target),
        "options": options.as_dict(),
        "report": report,
        "seconds": round(seconds, 3),
        "versions": versions(),
    }


if __name__ == "__main__":
    main()
