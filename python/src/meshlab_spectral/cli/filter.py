"""The command `meshlab-spectral filter`, and what it shares with `denoise`."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from meshlab_spectral.cli.filter_options import with_options
from meshlab_spectral.cli.messages import MESSAGES, errors_reported, warn_of_points_only
from meshlab_spectral.cli.progress import progress_shown
from meshlab_spectral.cli.report_table import report_table
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.process.single_file import filter_file_in_child

# "\b" keeps a paragraph's lines as they are.
FILTER_HELP = """Filter one mesh by the size of its details.

\b
Smooth a scan, removing what is smaller than 1 % of it:
  meshlab-spectral filter scan.ply smooth.ply --feature-size 2%
Sharpen it:
  meshlab-spectral filter scan.ply sharp.ply --filter-type high-pass \\
    --stop-gain 1 --pass-gain 2
"""


Source = Annotated[
    Path, typer.Argument(metavar="INPUT", help="Mesh to read: .ply, .obj, .stl, .off, ...")
]
Target = Annotated[
    Path,
    typer.Argument(
        metavar="OUTPUT",
        help="Mesh to write, in the format of its extension; replaces an existing file.",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the report as one JSON object.")]
Debug = Annotated[bool, typer.Option("--debug", hidden=True)]


@with_options(FilterOptions)
def filter_command(
    options: FilterOptions,
    source: Source,
    target: Target,
    as_json: AsJson = False,
    debug: Debug = False,
) -> None:
    """Filter one mesh: see `meshlab-spectral filter --help`."""
    filter_one_file(source, target, options, as_json, debug)


def filter_one_file(
    source: Path, target: Path, options: Options, as_json: bool, debug: bool
) -> None:
    """Filter one mesh, in a child process, and print the report."""
    if target.exists() and source.exists() and target.samefile(source):
        raise typer.BadParameter(
            f"{target} is INPUT itself and would be lost: choose another name", param_hint="OUTPUT"
        )
    begin = time.monotonic()
    with errors_reported(debug), progress_shown() as on_progress:
        report = filter_file_in_child(source, target, options, on_progress)
    warn_of_points_only(target.suffix)
    for warning in report["warnings"]:
        MESSAGES.print(f"Warning: {warning}.", markup=False, highlight=False, soft_wrap=True)
    if as_json:
        typer.echo(json.dumps(_record(source, target, options, report, time.monotonic() - begin)))
    else:
        if (summary := report.get("summary")) and summary not in report["warnings"]:
            told = f"{source.name}: {summary}"
            Console().print(told, markup=False, highlight=False, soft_wrap=True)
        Console().print(report_table(report, f"{source.name} -> {target.name}"))


def _record(
    source: Path, target: Path, options: Options, report: dict[str, Any], seconds: float
) -> dict[str, Any]:
    return {
        "input": str(source),
        "output": str(target),
        "options": options.as_dict(),
        "report": report,
        "seconds": round(seconds, 3),
        "versions": versions(),
    }
