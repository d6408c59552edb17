"""The command `meshlab-spectral compare`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from meshlab_spectral.cli.colour_files import (
    Overwrite,
    Picture,
    coloured_mesh,
    writing_coloured,
)
from meshlab_spectral.cli.filter_options import AsJson
from meshlab_spectral.cli.messages import errors_reported, print_result, print_warning
from meshlab_spectral.cli.progress import progress_shown
from meshlab_spectral.cli.report_table import change, table_of
from meshlab_spectral.figures.signed_mesh import comparison_sheet, write_signed
from meshlab_spectral.files.comparison import PERCENTILES, Comparison
from meshlab_spectral.workers.single_file import compare_in_child

_LABELS = {
    "displacement": "Displacement",
    "normal": "Along the normal",
    "tangential": "Along the surface",
    "a_to_b": "From A to B",
    "b_to_a": "From B to A",
}


def compare_command(
    a: Annotated[Path, typer.Argument(metavar="A", help="Mesh to compare with.")],
    b: Annotated[Path, typer.Argument(metavar="B", help="Mesh that is compared.")],
    output: Annotated[
        Path | None,
        coloured_mesh("the deviation of B as quality, and in colours: red outside A, blue inside"),
    ] = None,
    picture: Picture = None,
    max_distance: Annotated[
        float | None,
        typer.Option(
            metavar="LENGTH", min=0, help="Leave out what is farther than this from the other mesh."
        ),
    ] = None,
    overwrite: Overwrite = False,
    as_json: AsJson = False,
) -> None:
    """Compare two meshes: how far B is from A, and where.

    If both have the same faces, as before and after a filter, each vertex is compared with itself.
    Otherwise each vertex is compared with the nearest point of the other mesh, and what lies beyond
    its rim is left out. Lengths are in the units of the files, means and percentiles are over the
    surface.

      meshlab-spectral compare scan.ply smooth.ply
      meshlab-spectral compare scan.ply smooth.ply --picture change.png
      meshlab-spectral compare scan.ply smooth.ply --json
    """
    with (
        errors_reported("finished files are complete"),
        writing_coloured(output, picture, overwrite, a, b) as scratch,
    ):
        with progress_shown() as on_progress:
            result = compare_in_child(a, b, on_progress, bool(output or picture), max_distance)
        if scratch is not None:
            write_signed(*result.b, result.signed, result.color_extent, scratch)
        if picture is not None:
            comparison_sheet(result, (a.name, b.name)).save(picture)
    for warning in result.warnings:
        print_warning(warning)
    if as_json:
        record = {"a": str(a), "b": str(b), **result.report}
        if output is not None or picture is not None:
            record["colour_extent"] = result.color_extent
        typer.echo(json.dumps(record))
        return
    print_result(table_of(_rows(result), f"{a.name} -> {b.name}"))
    for path in (output, picture):
        if path is not None:
            print_result(path)


def _rows(result: Comparison) -> list[tuple[str, str]]:
    rows = []
    if not any(one.largest for one in result.deviations.values()):
        rows.append(("Deviation", "none: the surfaces are equal"))
    for name, one in result.deviations.items() if not rows else ():
        label = _LABELS[name]
        shares = " / ".join(f"{one.percentiles[p]:.4g}" for p in PERCENTILES)
        position = ", ".join(f"{x:.4g}" for x in one.position)
        rows += [
            (f"{label}: mean, rms", f"{one.mean:.4g}, {one.rms:.4g}"),
            (f"  {' / '.join(map(str, PERCENTILES))} % of the surface within", shares),
            ("  largest", f"{one.largest:.4g} at vertex {one.vertex} ({position})"),
        ]
    rows.append(("Area", change(*result.areas)))
    if result.volumes is not None:
        rows.append(("Volume", change(*result.volumes)))
    return rows
