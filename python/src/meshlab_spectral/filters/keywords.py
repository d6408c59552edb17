"""Functions that take a filter's options by name: their signatures and docstrings."""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Callable, Collection
from dataclasses import fields
from types import UnionType
from typing import Any, TypeVar, get_args, get_type_hints

from meshlab_spectral.filters.option_types import Length

Function = TypeVar("Function", bound=Callable[..., Any])

_OTHER = re.compile(r"\|(\w+)\|(?: (\d[\d.]*))?")


def takes_options(
    *tables: type[Any], names: Collection[str] | None = None
) -> Callable[[Function], Function]:
    """Spell out the ``**named`` of a function, for its `help` and for completion in notebooks.

    Type checkers read the annotation of ``**named`` instead. `tables` are tables of options, whose
    fields are made with `option`, of which the function takes those with `names`; None: all.
    """

    def spelled_out(function: Function) -> Function:
        types = {name: kind for table in tables for name, kind in get_type_hints(table).items()}
        every = [one for table in tables for one in fields(table)]
        chosen = [one for one in every if names is None or one.name in names]
        signature = inspect.signature(function)
        *others, named = signature.parameters.values()
        keywords = [
            named.replace(
                name=one.name,
                kind=inspect.Parameter.KEYWORD_ONLY,
                default=_plain(one.default),
                annotation=_type_named(types[one.name]),
            )
            for one in chosen
        ]
        texts = "".join(_explained(one, types[one.name]) for one in chosen)
        function.__signature__ = signature.replace(  # type: ignore[attr-defined]
            parameters=[*others, *keywords]
        )
        # getdoc, because before Python 3.13 docstrings keep the indentation of the source.
        function.__doc__ = (inspect.getdoc(function) or "").replace("**named\n", texts)
        return function

    return spelled_out


def _type_named(kind: Any) -> str:
    if kind is Length:
        return "str | float"
    if isinstance(kind, UnionType):  # paths may be given as strings, too
        return str(kind).replace("pathlib.Path", "str | Path")
    return "str" if get_args(kind) else str(kind.__name__)


def _plain(default: Any) -> Any:
    return str(default) if isinstance(default, Length) else default


def _explained(one: Any, kind: Any) -> str:
    """Return the docstring entry of an option: its help and its range."""
    facts = [repr(one) for one in get_args(kind) if not isinstance(kind, UnionType)]
    if of := one.metadata.get("range"):
        facts.append(of)
    indent = " " * 4
    text = _OTHER.sub(_as_keyword, one.metadata["help"])
    if facts:
        text += f" Range: {', '.join(facts)}."
    wrapped = textwrap.fill(text, 100, initial_indent=indent, subsequent_indent=indent)
    return f"{one.name}\n{wrapped}\n"


def _as_keyword(other: re.Match[str]) -> str:
    return f"{other[1]}={other[2]}" if other[2] else other[1]
