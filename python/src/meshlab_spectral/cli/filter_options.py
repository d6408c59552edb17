"""Command-line options generated from tables of options, `--preset`, and recipes."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, get_args, get_type_hints

import typer

from meshlab_spectral.batch.settings import Settings
from meshlab_spectral.cli.command_line import DENOISE, GROUP_OF, SOLVER, Command, with_parameters
from meshlab_spectral.cli.messages import flag, in_shell
from meshlab_spectral.errors import OptionError
from meshlab_spectral.files.presets import (
    PRESETS,
    equalizer_points,
    preset_names,
    preset_of,
)
from meshlab_spectral.files.recipe import load_recipe
from meshlab_spectral.files.region import Region
from meshlab_spectral.filters.option_types import AnyOptions, Length
from meshlab_spectral.filters.options import DenoiseOptions, FilterOptions
from meshlab_spectral.plugin.limits import byte_count

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
        help="Read options from a recipe, a TOML file; others on the command line override it.",
    ),
]
SaveRecipe = Annotated[
    Path | None,
    typer.Option(
        "--save-recipe",
        metavar="FILE",
        help="Save all options but those of a region as a recipe, for the next scan or a batch.",
    ),
]
SavePreset = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Save them as your own preset, for --preset NAME."),
]


def _use_preset(context: typer.Context, name: str | None) -> str | None:
    """Make the values of a preset the defaults of the command's other options."""
    if name is not None:
        try:
            _, values = preset_of(name)
        except OptionError as error:
            raise typer.BadParameter(str(error)) from error
        context.default_map = {**values, **(context.default_map or {})}  # an equalizer overrides
    return name


def _preset_option(tables: Collection[type[Any]]) -> typer.models.OptionInfo:
    """Return `--preset`, which explains what there is for the tables."""
    known = "; ".join(f"{n}: {one.purpose}" for n, one in PRESETS.items() if one.table in tables)
    option: typer.models.OptionInfo = typer.Option(
        is_eager=True,
        callback=_use_preset,
        metavar="NAME",
        autocompletion=lambda incomplete: [
            name for name in preset_names(*tables) if name.startswith(incomplete)
        ],
        help="Start from the options for a purpose, or from your own preset; others on the command "
        f"line override it. {known}.",
    )
    return option


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

# Tables that a command gets as objects, and the names of its arguments.
_OBJECTS: dict[type[Any], str] = {Settings: "settings", Region: "region"}


def with_options(
    *tables: type[Any], leave_out: Collection[str] = ()
) -> Callable[[Command], Command]:
    """Add the fields of tables to a command as options, passed on as `explicit` and as objects.

    `explicit` is a dict for `chosen_options`, with only the options set on the command line or by a
    preset; `settings` is a `Settings` and `region` a `Region`, if these are among the tables. Of
    fields with the same name the first is used; those to `leave_out` the command has no use for.
    FilterOptions brings `--preset` and `--equalizer`, too, DenoiseOptions the first.
    """
    added: dict[str, tuple[str, Any, Any, Any]] = {}
    of_objects: dict[str, type[Any]] = {}
    if {FilterOptions, DenoiseOptions} & set(tables):
        added["preset"] = ("preset", str | None, _preset_option(tables), None)
    if FilterOptions in tables:
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
            for name in ("filter_type", "transfer_function"):
                given = name in values and source(name).name == "COMMANDLINE"
                if given and values["equalizer"] is not None:
                    raise typer.BadParameter(f"--equalizer replaces {flag(name)}: leave one out")
            for table in set(of_objects.values()):
                names = [name for name, of in of_objects.items() if of is table]
                try:
                    arguments[_OBJECTS[table]] = table(**{name: values.pop(name) for name in names})
                except OptionError as error:
                    raise typer.BadParameter(in_shell(error)) from error
            if values:
                arguments["explicit"] = {
                    name: value
                    for name, value in values.items()
                    if source(name).name in ("COMMANDLINE", "DEFAULT_MAP")
                }
            command(**arguments)

        context = ("context", typer.Context, None, None)
        passed = {"explicit", *_OBJECTS.values()}
        return with_parameters(command, [context, *added.values()], run, passed)

    return decorate


def _parameter(one: Any, type_: Any, panel: str | None) -> tuple[str, Any, Any, Any]:
    """Convert a field for `with_parameters`; options of filters are checked by the core."""
    shown: dict[str, Any] = {"metavar": one.metadata["metavar"], "rich_help_panel": panel}
    shown["help"] = re.sub(r"\|(\w+)\|", lambda other: flag(other[1]), one.metadata["help"])
    if panel is None and "range" in one.metadata:
        shown["min"] = 1
    if type_ is Length:
        shown |= {"parser": _length, "metavar": "SIZE"}
    elif one.name == "memory_limit":
        shown["parser"] = memory_size
    elif any(" " in choice for choice in get_args(type_) if isinstance(choice, str)):
        shown["autocompletion"] = _completed(get_args(type_))
    default = str(one.default) if isinstance(one.default, Length) else one.default
    return one.name, type_, typer.Option(*one.metadata["flags"], **shown), default


def _completed(choices: Collection[str]) -> Callable[[str], list[str]]:
    """Return what completes choices with spaces, which need an escape in bash alone."""

    def complete(incomplete: str) -> list[str]:
        is_bash = os.environ.get("_MESHLAB_SPECTRAL_COMPLETE") == "complete_bash"
        space = "\\ " if is_bash else " "
        return [one.replace(" ", space) for one in choices if one.startswith(incomplete)]

    return complete


def chosen_options(
    table: type[AnyOptions], explicit: dict[str, Any], recipe: Path | None = None
) -> AnyOptions:
    """Return the options of a recipe, if any, overridden by the explicit ones.

    `table` is the class of the options, `explicit` comes from `with_options`. Raises OptionError if
    a value is invalid, or an option or the recipe is for another filter, and InputError when the
    recipe cannot be read.
    """
    found, options = (table, {}) if recipe is None else load_recipe(recipe)
    if found is not table:
        raise OptionError(f"the recipe {recipe} is for {found.TABLE}, not for {table.TABLE}")
    if "preset" in explicit and (of := preset_of(explicit["preset"])[0]) is not table:
        hint = ": add --denoise" if of is DenoiseOptions and recipe is None else ""
        raise OptionError(f"the preset {explicit['preset']} is for {of.TABLE}{hint}")
    shortcuts = {"preset", "equalizer"}
    known = {one.name for one in fields(table)} | {"preset"}
    known |= shortcuts if table is FilterOptions else set()
    for name in explicit:
        if name not in known:
            hint = ": add --denoise" if table is FilterOptions and recipe is None else ""
            raise OptionError(f"{flag(name)} is not an option of {table.TABLE}{hint}")
    values = {name: value for name, value in explicit.items() if name not in shortcuts}
    return table.from_dict({**options, **values})


def memory_size(text: str | int) -> int:
    """Parse a size of memory, such as 4GB."""
    if isinstance(text, int):
        return text
    size = byte_count(text)
    if size is None:
        raise typer.BadParameter(f"{text!r}: give a size such as 4GB or 500MB")
    return size


def _length(text: str | Length) -> Length:
    """Parse a length; its error names the option as it was written."""
    try:
        return text if isinstance(text, Length) else Length.parse(text)
    except OptionError as error:
        raise typer.BadParameter(str(error)) from error
