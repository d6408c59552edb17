"""Command-line options generated from tables of options, and `--preset`."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection
from dataclasses import fields
from typing import Annotated, Any, get_type_hints

import typer

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.option_types import AnyOptions, Length, Options
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.presets import PRESETS, Preset

Command = Callable[..., None]

# Of the commands that measure a file as a whole.
OneMesh = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Only the mesh of this name; by default all of the file together.",
        show_default=False,
    ),
]


def _use_preset(context: typer.Context, name: Preset | None) -> Preset | None:
    """Make the values of a preset the defaults of the command's other options."""
    if name is not None:
        context.default_map = {**(context.default_map or {}), **PRESETS[name]}
    return name


_PRESET = Annotated[
    Preset | None,
    typer.Option(
        is_eager=True,
        callback=_use_preset,
        help="Start from the options for a purpose; those given besides replace its own.",
        show_default=False,
    ),
]


def with_options(
    table: type[Options], names: Collection[str] | None = None
) -> Callable[[Command], Command]:
    """Add one option per field of a table to a command, passed as `options`.

    Parameters
    ----------
    table
        The table; a command with FilterOptions gets `--preset`, too.
    names
        Only these fields; the rest keep their defaults.
    """

    def decorate(command: Command) -> Command:
        def run(given: dict[str, Any], arguments: dict[str, Any]) -> None:
            command(options=_checked(table, given), **arguments)

        return _with_options(table, names, command, "options", run)

    return decorate


def with_given_filter_options(command: Command) -> Command:
    """Add one option per field of FilterOptions to a command, passed as `given`.

    `given` is a dict for `FilterOptions.from_dict` with only the options on the command line and
    of its preset, validated. The command needs a parameter `context: typer.Context`.
    """

    def run(values: dict[str, Any], arguments: dict[str, Any]) -> None:
        source = arguments["context"].get_parameter_source
        given = {
            name: value
            for name, value in values.items()
            if source(name).name in ("COMMANDLINE", "DEFAULT_MAP")
        }
        _checked(FilterOptions, given)
        command(given=given, **arguments)

    return _with_options(FilterOptions, None, command, "given", run)


def _checked(table: type[AnyOptions], given: dict[str, Any]) -> AnyOptions:
    try:
        return table(**given)
    except OptionError as error:
        raise typer.BadParameter(str(error)) from error


def _with_options(
    table: type[Options],
    names: Collection[str] | None,
    command: Command,
    place: str,
    call: Callable[[dict[str, Any], dict[str, Any]], None],
) -> Command:
    """Make a command with the options `names` and the parameters of `command` except `place`.

    It passes the values of the former and of the latter to `call`.
    """
    types = get_type_hints(table)
    own = [
        parameter
        for parameter in inspect.signature(command, eval_str=True).parameters.values()
        if parameter.name != place
    ]
    preset = inspect.Parameter(
        "preset", inspect.Parameter.KEYWORD_ONLY, default=None, annotation=_PRESET
    )
    added = [preset] if table is FilterOptions else []
    for option in fields(table):
        if names is not None and option.name not in names:
            continue
        settings: dict[str, Any] = {"help": option.metadata["help"]}
        type_, default = types[option.name], option.default
        if type_ is Length:
            settings |= {"parser": _length, "metavar": "SIZE"}
            default = str(default)
        added.append(
            inspect.Parameter(
                option.name,
                inspect.Parameter.KEYWORD_ONLY,
                default=default,
                annotation=Annotated[type_, typer.Option(**settings)],
            )
        )

    def run(**arguments: Any) -> None:
        values = {parameter.name: arguments.pop(parameter.name) for parameter in added}
        values.pop("preset", None)  # has done its work
        call(values, arguments)

    parameters = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in [*own, *added]]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {p.name: p.annotation for p in parameters}
    run.__doc__ = command.__doc__
    run.__name__ = command.__name__
    return run


def _length(text: str | Length) -> Length:
    try:
        return text if isinstance(text, Length) else Length.parse(text)
    except OptionError as error:
        raise typer.BadParameter(str(error)) from error
