"""Recipes: the filter's options in a TOML file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import tomli_w

from meshlab_spectral.errors import InputError, OptionError
from meshlab_spectral.files.whole_files import writing_whole
from meshlab_spectral.filters.options import FilterOptions, Length

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_TABLE = "filter"


def load_recipe(path: Path) -> dict[str, Any]:
    """Read the options in a recipe; options it leaves out keep their defaults.

    Returns
    -------
    dict
        Validated, for `FilterOptions.from_dict`.

    Raises
    ------
    InputError
        When the file cannot be read.
    OptionError
        When it is not TOML, or has an unknown key or an invalid value.
    """
    options = _table(path)
    try:
        FilterOptions.from_dict(options)
    except OptionError as error:
        raise OptionError(f"the recipe {path}: {error}") from error
    return options


def save_recipe(path: Path, options: FilterOptions) -> None:
    """Write all options to a recipe, which may replace another recipe but no other file.

    Raises
    ------
    InputError
        When the file exists and is not a recipe.
    MeshFileError
        When it cannot be written.
    """
    if path.is_file():
        try:
            _table(path)
        except OptionError as error:
            raise InputError(f"{error}; it is not replaced: choose another name") from error
    plain = {
        name: _number_or_text(getattr(options, name), value)
        for name, value in options.as_dict().items()
    }
    with writing_whole(path) as scratch:
        scratch.write_text(tomli_w.dumps({_TABLE: plain}), encoding="utf-8")


def _table(path: Path) -> dict[str, Any]:
    """Read the table of options."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"the recipe {path} cannot be read ({error.strerror})") from error
    except ValueError as error:  # invalid TOML or UTF-8
        raise OptionError(f"the recipe {path} is not a TOML file: {error}") from error
    except RecursionError as error:
        raise OptionError(
            f"the recipe {path} is nested too deeply: all options belong in the table [{_TABLE}]"
        ) from error
    unknown = content.keys() - {_TABLE}
    if unknown or not isinstance(content.get(_TABLE), dict):
        wrong = f"has {', '.join(sorted(unknown))} outside it" if unknown else "has no such table"
        raise OptionError(f"the recipe {path} {wrong}: all options belong in the table [{_TABLE}]")
    table: dict[str, Any] = content[_TABLE]
    return table


def _number_or_text(value: Any, plain: Any) -> Any:
    """Turn a length in the units of the mesh into a plain number."""
    is_number = isinstance(value, Length) and not (value.unit or value.automatic)
    return value.value if is_number else plain
