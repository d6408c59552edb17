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
FILTER_HELP = """Filter one mesh file by the size of its details.

Only coordinates and normals change, as long as INPUT and OUTPUT are of one format.

\b
Smooth a scan, removing bumps narrower than half a percent of it:
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
Mesh = Annotated[
    str | None,
    typer.Option(
        "--mesh",
        metavar="NAME",
        help="Only the mesh of this name; by default all meshes of the file, each by itself.",
        show_default=False,
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the report as one JSON object.")]
Debug = Annotated[bool, typer.Option("--debug", hidden=True)]


@with_options(FilterOptions)
def filter_command(
    options: FilterOptions,
    source: Source,
    target: Target,
    mesh: Mesh = None,
    as_json: AsJson = False,
    debug: Debug = False,
) -> None:
    """Filter one mesh: see `meshlab-spectral filter --help`."""
    filter_one_file(source, target, options, mesh, as_json, debug)


def filter_one_file(
    source: Path, target: Path, options: Options, mesh: str | None, as_json: bool, debug: bool
) -> None:
    """Filter one file, in a child process, and print the report."""
    if target.exists() and source.exists() and target.samefile(source):
        raise typer.BadParameter(
            f"{target} is INPUT itself and would be lost: choose another name", param_hint="OUTPUT"
        )
    begin = time.monotonic()
    with errors_reported(debug), progress_shown() as on_progress:
        report = filter_file_in_child(source, target, options, on_progress, mesh)
    warn_of_points_only(target.suffix)
    for warning in report["warnings"]:
        MESSAGES.print(f"Warning: {warning}.", markup=False, highlight=False, soft_wrap=True)
    if as_json:
        typer.echo(json.dumps(_record(source, target, options, report, time.monotonic() - begin)))
        return
    title = f"{source.name} -> {target.name}"
    for one in report.get("meshes", [report]):
        _tell(one, f"{title}, {one['mesh']}" if "meshes" in report else title, report["warnings"])


def _tell(report: dict[str, Any], title: str, warnings: list[str]) -> None:
    """Print the report of a mesh, but for a summary that has already been a warning."""
    if (summary := report.get("summary")) and not any(told.endswith(summary) for told in warnings):
        told = f"{title.partition(' -> ')[0]}: {summary}"
        Console().print(told, markup=False, highlight=False, soft_wrap=True)
    Console().print(report_table(report, title))


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
