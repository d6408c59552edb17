"""Types of options, and tables of them, which the core describes and checks."""

from __future__ import annotations

import difflib
import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from numbers import Integral, Real
from typing import Any, Literal, TypeVar

from meshlab_spectral import _core
from meshlab_spectral.errors import OptionError
from meshlab_spectral.other_words import instead_of

AnyOptions = TypeVar("AnyOptions", bound="Options")
Unit = Literal["", "%", "e"]


@dataclass(frozen=True)
class Length:
    """A length in the units of the mesh, its mean edges, or percent of its bounding box diagonal.

    Attributes
    ----------
    value
        In units of `unit`; finite, > 0.
    unit
        "" for the units of the mesh, "%" for percent of the diagonal, "e" for mean edges.
    automatic
        Whether the filter chooses the length to suit the mesh; `value` is then meaningless.
    """

    value: float = 0.0
    unit: Unit = ""
    automatic: bool = False

    def __post_init__(self) -> None:
        _core.length(self.exactly)

    @classmethod
    def parse(cls, text: str) -> Length:
        """Parse `5%` (of the diagonal), `6e` (mean edges), `0.02` (a length), or `auto`.

        Raises
        ------
        OptionError
            When `text` is none of these, or not positive.
        """
        return cls(*_core.length(text))

    @property
    def exactly(self) -> str:
        """The length as a text that is read as the same number."""
        number = repr(float(self.value)) if isinstance(self.value, Real) else repr(self.value)
        return "auto" if self.automatic else number + self.unit

    def __str__(self) -> str:
        return "auto" if self.automatic else f"{self.value:.12g}{self.unit}"


def option(
    default: Any,
    explanation: str,
    flags: Sequence[str] = (),
    metavar: str | None = None,
    **facts: Any,
) -> Any:
    """Make a field of a table of options; in its help, `|name|` is another option.

    `flags` and `metavar` are how a command spells the option, unless like its name, and what it
    calls the value. Of `facts`, "range" is that of a number in words.
    """
    return field(
        default=default,
        metadata={"help": explanation, "flags": flags, "metavar": metavar, **facts},
    )


@functools.cache
def _described() -> dict[str, dict[str, Any]]:
    return {one["python_name"]: one for one in _core.filters()}


def table_of(
    name: str, table: str, **flags: Sequence[str]
) -> Callable[[type[AnyOptions]], type[AnyOptions]]:
    """Make a class that only has annotations into the table of options of a filter of the core.

    `name` is the filter's, in Python, `table` that of the table in a recipe; `flags` are options
    that a command spells otherwise.
    """

    def made(cls: type[AnyOptions]) -> type[AnyOptions]:
        cls.FILTER, cls.TABLE = name, table
        for one in _described()[name]["parameters"]:
            if one["name"] in cls.__annotations__:
                more = {"range": one["range"]} if one["kind"] in ("int", "float") else {}
                given = flags.get(one["name"], ())
                setattr(cls, one["name"], option(_default(one), _help(one), given, **more))
        return dataclass(frozen=True, kw_only=True)(cls)

    return made


def _help(parameter: dict[str, Any]) -> str:
    text: str = parameter["help"].replace("*", "")
    if parameter["kind"] == "length" and "he default: " not in text:
        text += f" Default: {parameter['default_in_words']}."
    return text


def _default(parameter: dict[str, Any]) -> Any:
    default = parameter["default"]
    if parameter["kind"] == "length":
        return Length.parse(default)
    return parameter["choices"][default] if parameter["kind"] == "choice" else default


@dataclass(frozen=True, kw_only=True)
class Options:
    """Base of the tables of options, which are frozen dataclasses.

    A length may be given as a `Length`, a string such as "2%", or a number in the units of the
    mesh.

    Attributes
    ----------
    FILTER
        Python name of the plugin's filter.
    TABLE
        Name of the table in a recipe.

    Raises
    ------
    OptionError
        When a value is invalid; names the option, the value and what is allowed.
    """

    FILTER = ""
    TABLE = ""

    def __post_init__(self) -> None:
        for name, value in _core.checked(self.FILTER, self.core_parameters()).items():
            checked = Length(*value) if isinstance(value, tuple) else value
            object.__setattr__(self, name, checked)  # frozen for everybody else

    def as_dict(self) -> dict[str, Any]:
        """Return all options as plain values: strings, numbers, booleans."""
        plain = {one.name: getattr(self, one.name) for one in fields(self)}
        return {
            name: str(value) if isinstance(value, Length) else value
            for name, value in plain.items()
        }

    @classmethod
    def from_dict(cls: type[AnyOptions], plain: Mapping[str, Any]) -> AnyOptions:
        """Make options from plain values, as from `as_dict`; the rest keep their defaults."""
        known = [one.name for one in fields(cls)]
        for name in plain:
            if name not in known:
                similar = difflib.get_close_matches(name, known, n=1)
                hint = f"did you mean {similar[0]}?" if similar else f"choose {', '.join(known)}"
                raise OptionError(f"there is no option {name}: {instead_of(name) or hint}")
        return cls(**plain)

    @classmethod
    def from_call(
        cls: type[AnyOptions], options: AnyOptions | None, named: Mapping[str, object]
    ) -> AnyOptions:
        """Return the options of a call, given as one object or by name; OptionError if by both."""
        if options is None:
            return cls.from_dict(named)
        if not isinstance(options, cls):
            raise OptionError(f"options = {type(options).__name__}: must be {cls.__name__}")
        if named:
            raise OptionError(
                f"{', '.join(named)}: give options as one object or by name, not both"
            )
        return options

    def core_parameters(self) -> dict[str, bool | int | float | str]:
        """Return the values for the core: lengths are texts."""
        return {one.name: _plain(getattr(self, one.name)) for one in fields(self)}

    def sizes(
        self, diagonal: float, mean_edge: float, surface_diagonal: float
    ) -> dict[str, float | None]:
        """Return the lengths in the units of a mesh; None: the filter measures it, or none is set.

        Defaults refer to the diagonal of the triangles alone.
        """
        given = self.core_parameters()
        return _core.sizes(self.FILTER, given, diagonal, mean_edge, surface_diagonal)


def _plain(value: Any) -> Any:
    if isinstance(value, Length):
        return value.exactly
    if str(getattr(value, "dtype", "")) == "bool" and value.shape == ():  # without importing NumPy
        return bool(value)
    is_percentage = type(value).__name__ == "PercentageValue"  # of pymeshlab
    return f"{value.value()}%" if is_percentage else value


def checked_count(name: str, value: Any, least: int = 1) -> int:
    """Return a count as an int; raise OptionError unless it is an integer >= `least`."""
    is_whole = isinstance(value, Integral) and not isinstance(value, bool)
    count = int(value) if is_whole else least - 1
    if not least <= count < 2**31:
        raise OptionError(f"{name} = {value}: must be an integer from {least} to {2**31 - 1}")
    return count
