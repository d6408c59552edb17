"""The command `meshlab-spectral texture`: one file, or many as one table."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from meshlab_spectral.cli.colour_files import (
    Overwrite,
    Picture,
    coloured_mesh,
    refuse_existing,
    writing_coloured,
)
from meshlab_spectral.cli.filter_options import (
    AsJson,
    OneMesh,
    chosen_options,
    with_options,
)
from meshlab_spectral.cli.messages import errors_reported, print_error, print_result, print_warning
from meshlab_spectral.cli.progress import progress_shown
from meshlab_spectral.cli.report_table import table_of
from meshlab_spectral.errors import MeshError, OptionError, SpectralError
from meshlab_spectral.figures.signed_mesh import full_height, texture_sheet, write_signed
from meshlab_spectral.files.extensions import check_ending
from meshlab_spectral.files.region import Region
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.whole_files import writing_whole
from meshlab_spectral.filters.options import TextureOptions
from meshlab_spectral.filters.texture import SurfaceTexture
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.workers.single_file import texture_in_child

_BEARING = (10, 50, 90)


# Of the table and the CSV file of many.
_COLUMNS = ("Sa", "Sq", "Sz", "Ssk", "Sku", "Sdq", "Sdr", "Sk", "Spk", "Svk")


@with_options(TextureOptions, Region)
def texture_command(
    explicit: dict[str, Any],
    region: Region,
    sources: Annotated[
        list[Path], typer.Argument(metavar="MESH", help="Meshes to read: .ply, .obj, .stl, ...")
    ],
    output: Annotated[
        Path | None,
        coloured_mesh(
            "the height as quality, and in colours: red peaks, blue valleys, full at three Sq"
        ),
    ] = None,
    picture: Picture = None,
    overwrite: Overwrite = False,
    mesh: OneMesh = None,
    unit: Annotated[
        str,
        typer.Option(metavar="UNIT", help="Unit of length, such as mm; default: the file's."),
    ] = "",
    smr: Annotated[
        list[float] | None,
        typer.Option(
            metavar="C", help="Report Smr(C), too: the share of the area at least C high."
        ),
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option("--csv", metavar="FILE", help="Write all numbers as CSV, one row per mesh."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Measure roughness: Sa, Sq, Sz and others of ISO 25178-2.

    Roughness is separated from waviness, form and noise by cutoff wavelengths (nesting indices),
    with the Gaussian filter of ISO 16610-61 on a fitted plane, sphere or cylinder, or on the smooth
    surface itself, whatever its shape. Lengths are in the units of the file.

      meshlab-spectral texture part.stl --waviness 0.8 --noise 0.0025
      meshlab-spectral texture part.stl --waviness 0.8 --output heights.ply
      meshlab-spectral texture block.ply --form plane --where 'nz > 0.5'
      meshlab-spectral texture bore.ply --form cylinder --selected --json
      meshlab-spectral texture coupon*.ply --waviness 0.8 --csv table.csv
    """
    many = len(sources) > 1
    with (
        errors_reported("finished files are complete"),
        writing_coloured(output, picture, overwrite, *sources) as scratch,
    ):
        if many and (output or picture):
            raise OptionError("--output and --picture are of one mesh: name only one")
        if table is not None:
            check_ending(table, "the table is a CSV file", ".csv")
            refuse_existing(table, overwrite)
        options = chosen_options(TextureOptions, explicit)
        measured: list[tuple[Path, SurfaceTexture]] = []
        failed = 0
        for source in sources:
            try:
                with progress_shown() as on_progress:
                    request = Request(source, options, mesh, region)
                    V, F, texture = texture_in_child(request, on_progress)
            except SpectralError as error:
                if not many:
                    if isinstance(error, OptionError) and not (explicit or region):
                        raise MeshError(str(error)) from error  # the mesh's: no option was given
                    raise
                print_error(f"{source}: {error}")
                failed += 1
                continue
            if scratch is not None:
                write_signed(V, F, texture.height, full_height(texture), scratch)
            if picture is not None:
                texture_sheet(V, F, texture, source.name).save(picture)
            numbers = replace(texture, height=texture.height[:0].copy(), unit=unit or texture.unit)
            measured.append((source, numbers))
            for warning in texture.warnings:
                print_warning(f"{source}: {warning}" if many else warning)
        records = [_record(source, texture, output, smr or ()) for source, texture in measured]
        if table is not None:
            with writing_whole(table) as rows:
                _write_table(records, rows)
    if as_json:
        printed = {"files": records} if many else records[0]
        typer.echo(json.dumps({**printed, "versions": versions()}))
    elif many:
        print_result(_table_of_many(records))
    else:
        print_result(table_of(_rows(measured[0][1], smr or ()), sources[0].name))
    if not as_json:
        for path in (output, picture, table):
            if path is not None:
                print_result(path)
    if failed:
        raise typer.Exit(1)


def _record(
    source: Path, texture: SurfaceTexture, output: Path | None, smr: Sequence[float]
) -> dict[str, Any]:
    """Return all that is known of a file, for JSON."""
    record: dict[str, Any] = {
        "input": str(source),
        "output": None if output is None else str(output),
        **texture.report,
    }
    if smr:
        record["Smr"] = {f"{c:g}": float(texture.material_ratio(c)) for c in smr}
    return record


def _write_table(records: Sequence[dict[str, Any]], path: Path) -> None:
    """Write the numbers of all files as CSV; vectors and warnings are left to JSON."""
    plain = [
        {name: value for name, value in one.items() if isinstance(value, str | float | int)}
        | {f"Smr({c})": value for c, value in one.get("Smr", {}).items()}
        for one in records
    ]
    names = list(dict.fromkeys(name for one in plain for name in one if name != "output"))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(plain)


def _table_of_many(records: Sequence[dict[str, Any]]) -> Table:
    units = {one.get("unit", "") for one in records}
    title = "Surface texture"
    if len(units) == 1 and any(units):
        title += f", lengths in {units.pop()}"
    table = Table(title=title, title_justify="left", title_style="bold")
    table.add_column("file", style="cyan")
    for name in ("unit",) * (len(units) > 1) + _COLUMNS:
        table.add_column(name, justify="right")
    for one in records:
        numbers = [f"{one[name]:.4g}" for name in _COLUMNS]
        table.add_row(Path(one["input"]).name, *[one.get("unit", "")] * (len(units) > 1), *numbers)
    return table


def _rows(texture: SurfaceTexture, smr: Sequence[float]) -> list[tuple[str, str]]:
    unit = texture.unit

    def length(number: float) -> str:
        return f"{number:.4g} {unit}".rstrip()

    counts = (
        texture.vertices_evaluated,
        texture.vertices_left_out,
        texture.vertices_too_thin,
    )
    above = (f"{texture.bearing_heights[percent]:.4g}" for percent in _BEARING)
    form = [] if texture.form_radius is None else [("Radius of the form", texture.form_radius)]
    lags = [] if texture.Sal is None else [("Sal, autocorrelation length", length(texture.Sal))]
    if texture.Str is not None:
        lags.append(("Str, aspect ratio", f"{texture.Str:.4g}"))
    return [
        ("Waviness cutoff (L-filter)", length(texture.waviness) if texture.waviness else "none"),
        ("Noise cutoff (S-filter)", length(texture.noise) if texture.noise else "none"),
        ("Sa, mean height", length(texture.Sa)),
        ("Sq, rms height", length(texture.Sq)),
        ("Ssk, skewness", f"{texture.Ssk:.4g}"),
        ("Sku, kurtosis", f"{texture.Sku:.4g}"),
        ("Sp, highest peak", length(texture.Sp)),
        ("Sv, deepest valley", length(texture.Sv)),
        ("Sz, both", length(texture.Sz)),
        ("Sdq, rms slope", f"{texture.Sdq:.4g}"),
        ("Sdr, additional area", f"{100 * texture.Sdr:.4g} %"),
        ("Sk, core height", length(texture.Sk)),
        ("Spk, reduced peaks", length(texture.Spk)),
        ("Svk, reduced valleys", length(texture.Svk)),
        ("Smr1, Smr2", f"{100 * texture.Smr1:.4g} %, {100 * texture.Smr2:.4g} %"),
        *lags,
        *((f"Smr({c:g})", f"{100 * float(texture.material_ratio(c)):.4g} %") for c in smr),
        ("Exceeded by 10 / 50 / 90 % of the area", f"{' / '.join(above)} {unit}".rstrip()),
        *((name, length(radius)) for name, radius in form),
        ("Vertices evaluated, left out, too thin", "{}, {}, {}".format(*counts)),
    ]
