"""Recipes: the filter's options in a TOML file, to be kept and used again."""

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
    """Read the options that a recipe gives; those that it leaves out have their defaults.

    Returns
    -------
    dict
        For `FilterOptions.from_dict`; checked.

    Raises
    ------
    InputError
        When the file cannot be read.
    OptionError
        When it is no TOML, has a key that is unknown, or a value that an option cannot take.
    """
    options = _table(path)
    try:
        FilterOptions.from_dict(options)
    except OptionError as error:
        raise OptionError(f"the recipe {path}: {error}") from error
    return options


def save_recipe(path: Path, options: FilterOptions) -> None:
    """Write all options into a recipe; it may replace another recipe, and no other file.

    Raises
    ------
    InputError
        When there is a file that is no recipe.
    MeshFileError
        When it cannot be written.
    """
    if path.is_file():
        try:
            _table(path)
        except OptionError as error:
            raise InputError(f"{error}; so it is not replaced: give another name") from error
    plain = {
        name: _number_or_text(getattr(options, name), value)
        for name, value in options.as_dict().items()
    }
    with writing_whole(path) as scratch:
        scratch.write_text(tomli_w.dumps({_TABLE: plain}), encoding="utf-8")


def _table(path: Path) -> dict[str, Any]:
    """Read the table that a recipe is."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"the recipe {path} cannot be read ({error.strerror})") from error
    except ValueError as error:  # of TOML, or of UTF-8
        raise OptionError(f"the recipe {path} is no TOML file: {error}") from error
    unknown = content.keys() - {_TABLE}
    if unknown or not isinstance(content.get(_TABLE), dict):
        wrong = f"has {', '.join(sorted(unknown))} outside of it" if unknown else "has none"
        raise OptionError(
            f"the recipe {path} {wrong}: all options belong into one table, [{_TABLE}]"
        )
    table: dict[str, Any] = content[_TABLE]
    return table


def _number_or_text(value: Any, plain: Any) -> Any:
    """Give a length in the units of the mesh as the number that it is."""
    is_number = isinstance(value, Length) and not (value.relative or value.automatic)
    return value.value if is_number else plain
