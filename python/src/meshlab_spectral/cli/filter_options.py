"""Command-line options generated from tables of options, `--preset`, and recipes."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from meshlab_spectral.batch.settings import Settings
from meshlab_spectral.cli.command_line import DENOISE, GROUP_OF, SOLVER, Command, with_parameters
from meshlab_spectral.errors import OptionError
from meshlab_spectral.files.recipe import load_recipe
from meshlab_spectral.files.region import Region
from meshlab_spectral.filters.option_types import AnyOptions, Length
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.presets import PRESETS, Preset, equalizer_points

_SIZE = re.compile(r"(?P<number>\d+(\.\d+)?)\s*(?P<unit>[KMGT]?)(i?B)?", re.IGNORECASE)
_UNITS = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}

Source = Annotated[
    Path, typer.Argument(metavar="MESH", help="Mesh to read: .ply, .obj, .stl, .off, ...")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the result as one JSON object.")]
# For the commands that measure a file as a whole.
OneMesh = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Only the mesh of this name; by default all meshes of the file, as one.",
    ),
]
Recipe = Annotated[
    Path | None,
    typer.Option(
        "--recipe",
        metavar="FILE",
        help="Read options from a recipe, a TOML file; options given as well take precedence.",
    ),
]
SaveRecipe = Annotated[
    Path | None,
    typer.Option(
        "--save-recipe",
        metavar="FILE",
        help="Write all options but those of a region to a recipe, for the next scan or a batch.",
    ),
]


def _use_preset(context: typer.Context, name: Preset | None) -> Preset | None:
    """Make the values of a preset the defaults of the command's other options."""
    if name is not None:
        context.default_map = {**(context.default_map or {}), **PRESETS[name]}
    return name


def _use_equalizer(context: typer.Context, gains: str | None) -> str | None:
    """Make the gains of an equalizer the defaults of `--filter-type` and `--transfer-function`."""
    if gains is not None:
        try:
            points = equalizer_points([float(gain) for gain in gains.split(",")])
        except ValueError as error:
            raise typer.BadParameter(f"{gains}: {error}") from error
        custom = {"filter_type": "custom", "transfer_function": points}
        context.default_map = {**(context.default_map or {}), **custom}
    return gains


_EQUALIZER = typer.Option(
    is_eager=True,
    callback=_use_equalizer,
    metavar="GAINS",
    help="Gains of details of 96, 48, 24, 12, 6 and 3 mean edges, such as 1,1,2,1,0.5,0: the "
    "sliders of MeshLab's Spectral Equalizer. Replaces --filter-type and --transfer-function.",
)
_PRESET = typer.Option(
    is_eager=True,
    callback=_use_preset,
    help="Start from the options for a purpose; options given as well take precedence.",
)


# Tables that a command gets as objects, and the names of its arguments.
_OBJECTS: dict[type[Any], str] = {Settings: "settings", Region: "region"}


def with_options(
    *tables: type[Any], leave_out: Collection[str] = ()
) -> Callable[[Command], Command]:
    """Add the fields of tables to a command as options, passed on as `given` and as objects.

    `given` is a dict for `chosen_options`, with only the options set on the command line or by a
    preset; `settings` is a `Settings` and `region` a `Region`, if these are among the tables.

    Parameters
    ----------
    *tables
        The tables; of fields with the same name the first is used. FilterOptions brings `--preset`
        and `--equalizer`, too.
    leave_out
        Fields that the command has no use for.
    """
    added: dict[str, tuple[str, Any, Any, Any]] = {}
    of_objects: dict[str, type[Any]] = {}
    if FilterOptions in tables:
        added["preset"] = ("preset", Preset | None, _PRESET, None)
        added["equalizer"] = ("equalizer", str | None, _EQUALIZER, None)
    for table in tables:
        types = get_type_hints(table)
        for one in fields(table):
            if one.name in added or one.name in leave_out:
                continue
            panel: str | None = GROUP_OF.get(one.name, SOLVER) if table is tables[0] else DENOISE
            if table in _OBJECTS:
                of_objects[one.name] = table
                panel = None
            added[one.name] = _parameter(one, types[one.name], panel)

    def decorate(command: Command) -> Command:
        def run(arguments: dict[str, Any]) -> None:
            source = arguments.pop("context").get_parameter_source
            values = {name: arguments.pop(name) for name in added}
            for table in set(of_objects.values()):
                names = [name for name, of in of_objects.items() if of is table]
                try:
                    arguments[_OBJECTS[table]] = table(**{name: values.pop(name) for name in names})
                except OptionError as error:
                    raise typer.BadParameter(f"--{error}") from error
            if values:
                arguments["given"] = {
                    name: value
                    for name, value in values.items()
                    if source(name).name in ("COMMANDLINE", "DEFAULT_MAP")
                }
            command(**arguments)

        context = ("context", typer.Context, None, None)
        passed = {"given", *_OBJECTS.values()}
        return with_parameters(command, [context, *added.values()], run, passed)

    return decorate


def _parameter(one: Any, type_: Any, panel: str | None) -> tuple[str, Any, Any, Any]:
    """Convert a field for `with_parameters`; ranges of filter options are checked by `Options`."""
    shown: dict[str, Any] = {key: one.metadata[key] for key in ("help", "metavar")}
    shown["rich_help_panel"] = panel
    if panel is None and one.metadata["limits"]:
        shown["min"] = one.metadata["limits"].low
    if type_ is Length:
        shown |= {"parser": _length, "metavar": "SIZE"}
    elif one.name == "memory_limit":
        shown["parser"] = byte_count
    default = str(one.default) if type_ is Length else one.default
    return one.name, type_, typer.Option(*one.metadata["flags"], **shown), default


def chosen_options(
    table: type[AnyOptions], given: dict[str, Any], recipe: Path | None = None
) -> AnyOptions:
    """Return the options of a recipe, if any, overridden by those given.

    `table` is the class of the options, `given` comes from `with_options`. Raises OptionError when
    a value is invalid, or an option or the recipe is for another filter, and InputError when the
    recipe cannot be read.
    """
    found, options = (table, {}) if recipe is None else load_recipe(recipe)
    if found is not table:
        raise OptionError(f"the recipe {recipe} is for {found.TABLE}, not for {table.TABLE}")
    shortcuts = {"preset", "equalizer"}
    known = {one.name for one in fields(table)} | (shortcuts if table is FilterOptions else set())
    for name in given:
        if name not in known:
            hint = ": add --denoise" if table is FilterOptions and recipe is None else ""
            spelled = name.replace("_", "-")
            raise OptionError(f"--{spelled} is not an option of {table.TABLE}{hint}")
    values = {name: value for name, value in given.items() if name not in shortcuts}
    return table.from_dict({**options, **values})


def byte_count(text: str | int) -> int:
    """Parse a size of memory, such as 4GB."""
    if isinstance(text, int):
        return text
    match = _SIZE.fullmatch(text.strip())
    size = int(float(match["number"]) * _UNITS[match["unit"].upper()]) if match else 0
    if not size:
        raise typer.BadParameter(f"{text!r}: give a size such as 4GB or 500MB")
    return size


def _length(text: str | Length) -> Length:
    try:
        return text if isinstance(text, Length) else Length.parse(text)
    except OptionError as error:
        raise typer.BadParameter(str(error)) from error
