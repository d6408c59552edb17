"""Recipes: a filter's options in a TOML file, in a table named after the filter."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import tomli_w

from meshlab_spectral.errors import InputError, OptionError
from meshlab_spectral.files.whole_files import writing_whole
from meshlab_spectral.filters.option_types import Length, Options
from meshlab_spectral.filters.tables import TABLES
from meshlab_spectral.formats.names import shown

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


_NAMED, _LONGEST = 5, 1000  # unknown keys, and characters of what is wrong with a value


def load_recipe(path: Path) -> tuple[type[Options], dict[str, Any]]:
    """Return the class of the options in a recipe, and the validated options for its `from_dict`.

    Raises InputError when the file cannot be read, OptionError for what is wrong in it.
    """
    table, options = _content(path)
    try:
        table.from_dict(options)
    except OptionError as error:
        raise OptionError(f"the recipe {path}: {shown(error, _LONGEST)}") from error
    return table, options


@contextlib.contextmanager
def saving_recipe(path: Path | None, options: Options | None) -> Iterator[None]:
    """Write all options to a recipe, which may replace another recipe but no other file.

    It is written once the block has succeeded, and not at all if `path` or `options` is None.
    Raises InputError when the file exists and is not a recipe, and as `writing_whole` does.
    """
    if path is None or options is None:
        yield
        return
    if path.is_file():
        try:
            _content(path)
        except OptionError as error:
            raise InputError(f"{error}; it is not replaced: choose another name") from error
    plain = {
        name: _number_or_text(getattr(options, name), value)
        for name, value in options.as_dict().items()
    }
    with writing_whole(path) as scratch:
        scratch.write_text(tomli_w.dumps({options.TABLE: plain}), encoding="utf-8")
        yield


def _content(path: Path) -> tuple[type[Options], dict[str, Any]]:
    """Read the only table: the class of its options, and their values."""
    names = " or ".join(f"[{name}]" for name in TABLES)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"the recipe {path} cannot be read ({error.strerror})") from error
    except ValueError as error:  # invalid TOML or UTF-8
        raise OptionError(f"the recipe {path} is not a TOML file: {error}") from error
    except RecursionError as error:
        raise OptionError(
            f"the recipe {path} is nested too deeply: all options belong in one table, {names}"
        ) from error
    unknown = content.keys() - TABLES.keys()
    if unknown or len(content) != 1 or not all(isinstance(v, dict) for v in content.values()):
        wrong = "has several tables" if len(content) > 1 else "has no table"
        if unknown:
            wrong = f"has {', '.join(map(shown, sorted(unknown)[:_NAMED]))} outside it"
        raise OptionError(f"the recipe {path} {wrong}: all options belong in one table, {names}")
    ((name, options),) = content.items()
    return TABLES[name], options


def _number_or_text(value: Any, plain: Any) -> Any:
    """Turn a length in the units of the mesh into a plain number."""
    is_number = isinstance(value, Length) and not (value.unit or value.automatic)
    return value.value if is_number else plain
