"""The commands `meshlab-spectral filter` and `meshlab-spectral denoise`, for one file."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from meshlab_spectral.cli.colour_files import (
    Overwrite,
    Picture,
    writing_coloured,
)
from meshlab_spectral.cli.command_line import Command
from meshlab_spectral.cli.filter_options import (
    AsJson,
    Recipe,
    SavePreset,
    SaveRecipe,
    chosen_options,
    memory_size,
    with_options,
)
from meshlab_spectral.cli.intent import print_intent
from meshlab_spectral.cli.messages import (
    VERBOSITY,
    errors_reported,
    print_message,
    print_result,
    print_warning,
    warn_of_points_only,
)
from meshlab_spectral.cli.progress import progress_shown
from meshlab_spectral.cli.report_table import report_table
from meshlab_spectral.cli.streams import STREAM, as_files
from meshlab_spectral.errors import OptionError
from meshlab_spectral.files.presets import preset_place
from meshlab_spectral.files.recipe import saving_recipe
from meshlab_spectral.files.region import Region
from meshlab_spectral.files.request import Request
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import DenoiseOptions, FilterOptions
from meshlab_spectral.plugin.limits import name_memory_limit, set_memory_limit
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.tiles import MOST_TILES
from meshlab_spectral.tiles.whole_or_tiles import filter_file, intent_of_file
from meshlab_spectral.workers.single_file import compare_in_child

FILTER_HELP = """Filter one mesh file by the size of its details.

If INPUT and OUTPUT have the same format, only coordinates and normals change.

Smooth a scan, removing bumps narrower than half a percent of it:
  meshlab-spectral filter scan.ply smooth.ply --feature-size 2%
Sharpen it:
  meshlab-spectral filter scan.ply sharp.ply --filter-type high-pass \\
    --stop-gain 1 --pass-gain 2
Save the options, and filter a folder with them:
  meshlab-spectral filter scan.ply smooth.ply --feature-size 2% \\
    --save-recipe smooth.toml
  meshlab-spectral batch scans --output smooth --recipe smooth.toml
"""
DENOISE_HELP = """Detect and remove the noise of a scanner, spikes or voxel steps.

  meshlab-spectral denoise scan.ply clean.ply
Only its upper part:
  meshlab-spectral denoise scan.ply clean.ply --where 'z > 3'
A folder of scans:
  meshlab-spectral batch scans --output clean --denoise
"""


def _tiles(text: str | int) -> int | None:
    """Return a number of tiles, 0 for `auto`, None for `off`."""
    if isinstance(text, int):
        return text
    named = {"auto": 0, "off": None}
    if text in named:
        return named[text]
    if not text.isdecimal() or not 2 <= int(text) <= MOST_TILES:
        raise typer.BadParameter(f"{text!r}: give auto, off or a number from 2 to {MOST_TILES}")
    return int(text)


def _command_with(table: type[Options], help_text: str) -> Command:
    """Make the command for the filter that a table of options belongs to."""

    @with_options(table, Region)
    def command(
        explicit: dict[str, Any],
        region: Region,
        source: Annotated[
            Path,
            typer.Argument(
                metavar="INPUT",
                help="Mesh to read: .ply, .obj, .stl, .off, ...; - is standard input.",
            ),
        ],
        target: Annotated[
            Path | None,
            typer.Argument(
                metavar="OUTPUT",
                help="Mesh to write, in the format of its extension; - is standard output.",
            ),
        ] = None,
        output: Annotated[
            Path | None,
            typer.Option("--output", "-o", metavar="FILE", help="The same as OUTPUT."),
        ] = None,
        mesh: Annotated[
            str | None,
            typer.Option(
                metavar="NAME",
                help="Only the mesh of this name; by default all meshes of the file, each by "
                "itself.",
            ),
        ] = None,
        overwrite: Overwrite = False,
        ending: Annotated[
            str | None,
            typer.Option("--format", metavar="ENDING", help="Format of standard output: ply, ..."),
        ] = None,
        tiles: Annotated[
            int | None,
            typer.Option(
                parser=_tiles,
                metavar="auto|off|N",
                show_default=False,
                help="Process binary PLY or STL in N overlapping tiles, from file to file; auto "
                "(the default): where the mesh does not fit in memory.",
            ),
        ] = 0,
        memory: Annotated[
            int | None,
            typer.Option(
                parser=memory_size,
                metavar="SIZE",
                help="Memory limit, such as 4GB; by default the free memory.",
            ),
        ] = None,
        scheduler: Annotated[
            str | None,
            typer.Option(
                metavar="ADDRESS",
                help="Process the tiles on the workers of the Dask cluster with a scheduler such "
                "as host:8786; they must see INPUT and the folder of OUTPUT under the same paths. "
                "Excludes --memory.",
            ),
        ] = None,
        dry_run: Annotated[
            bool,
            typer.Option(
                "--dry-run",
                "-n",
                help="Print what would be done, with sizes in the units of the file; nothing is "
                "written.",
            ),
        ] = False,
        recipe: Recipe = None,
        save_recipe: SaveRecipe = None,
        save_preset: SavePreset = None,
        picture: Picture = None,
        color_displacement: Annotated[
            Path | None,
            typer.Option(
                metavar="FILE",
                help="Also write OUTPUT as .ply, with the displacement of each vertex along its "
                "normal as quality and in colours: red outwards, blue inwards.",
            ),
        ] = None,
        as_json: AsJson = False,
    ) -> None:
        """Filter one file, in a child process, and print the report."""
        if target is not None and output is not None:
            raise typer.BadParameter(f"OUTPUT is {target} already", param_hint="--output")
        destination = target or output
        if destination is None:
            raise typer.BadParameter("name the mesh to write", param_hint="OUTPUT")
        if destination.exists() and source.exists() and destination.samefile(source):
            raise typer.BadParameter(
                f"{destination} is INPUT itself and would be lost: choose another name",
                param_hint="OUTPUT",
            )
        if destination.is_file() and not overwrite:
            raise typer.BadParameter(
                f"{destination} exists: choose another name, or replace it with --overwrite",
                param_hint="OUTPUT",
            )
        if (
            color_displacement is not None
            and color_displacement.absolute() == destination.absolute()
        ):
            raise typer.BadParameter(
                f"{destination} is OUTPUT: choose another name", param_hint="--color-displacement"
            )
        if as_json and destination == STREAM and not dry_run:
            raise typer.BadParameter(
                "standard output has the mesh already: name a file", param_hint="--json"
            )
        begin = time.monotonic()
        with (
            errors_reported(),
            writing_coloured(
                None if dry_run else color_displacement, picture, overwrite, source
            ) as coloured,
            as_files(source, destination, ending) as (read, written),
        ):
            options = chosen_options(table, explicit, recipe)
            if memory is not None:
                if scheduler is not None:
                    raise OptionError("a cluster configures its own workers: leave out --memory")
                set_memory_limit(memory)
                name_memory_limit("--memory")
            request = Request(read, options, mesh, region)
            if dry_run:
                with progress_shown() as on_progress:
                    intent = intent_of_file(request, written, on_progress, tiles, scheduler)
                print_intent(source, destination, options, intent, as_json)
                return
            if save_preset is not None:
                save_recipe = preset_place(save_preset)
            with saving_recipe(save_recipe, options), progress_shown() as on_progress:
                report = filter_file(
                    request, written, on_progress, overwrite, tiles, print_message, scheduler
                )
            if picture is not None or coloured is not None:
                # A slow import.
                from meshlab_spectral.figures.signed_mesh import comparison_sheet, write_signed

                with progress_shown() as on_progress:
                    change = compare_in_child(read, written, on_progress, whole=True)
                if coloured is not None:
                    write_signed(*change.b, change.signed, change.color_extent, coloured)
                    report["color_extent"] = change.color_extent
                if picture is not None:
                    comparison_sheet(change, (source.name, destination.name)).save(picture)
        if save_recipe is not None and region:
            names = ", ".join(f"--{name}" for name in region.given())
            print_warning(f"{save_recipe} does not hold {names}: a region is of one file")
        warn_of_points_only(destination.suffix)
        for warning in report["warnings"]:
            print_warning(warning)
        if destination == STREAM:
            return
        if as_json:
            seconds = time.monotonic() - begin
            typer.echo(json.dumps(_record(source, destination, options, region, report, seconds)))
        else:
            _print_reports(report, source.name, destination.name)
            if color_displacement is not None:
                extent = f"{report['color_extent']:.3g}"
                print_result(f"{color_displacement}: red {extent} outwards, blue {extent} inwards")

    command.__doc__ = help_text
    return command


filter_command = _command_with(FilterOptions, FILTER_HELP)
denoise_command = _command_with(DenoiseOptions, DENOISE_HELP)


def _print_reports(report: dict[str, Any], source: str, target: str) -> None:
    for one in report.get("meshes", [report]):
        name = f", {one['mesh']}" if "meshes" in report else ""
        # If nothing was removed, a warning has said why.
        if (told := one.get("summary")) and "nothing_removed" not in one["warning_codes"]:
            print_result(f"{source}{name}: {told}")
        print_result(report_table(one, f"{source} -> {target}{name}", VERBOSITY.verbose))


def _record(
    source: Path,
    target: Path,
    options: Options,
    region: Region,
    report: dict[str, Any],
    seconds: float,
) -> dict[str, Any]:
    return {
        "input": str(source),
        "output": str(target),
        "options": options.as_dict(),
        **({"region": region.given()} if region else {}),
        "report": report,
        "seconds": round(seconds, 3),
        "versions": versions(),
    }
