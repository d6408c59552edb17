"""Types of options, and tables of them: values are checked and converted for pymeshlab."""

from __future__ import annotations

import difflib
import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from numbers import Integral, Real
from typing import Any, Literal, TypeVar, get_args, get_type_hints

from meshlab_spectral.errors import OptionError
from meshlab_spectral.other_words import instead_of

AnyOptions = TypeVar("AnyOptions", bound="Options")

# What pymeshlab can pass on: 32-bit integers and single-precision floats.
LARGEST_INTEGER = 2**31 - 1
_SMALLEST_FLOAT, _LARGEST_FLOAT = 2.0**-126, (2 - 2.0**-23) * 2.0**127


@dataclass(frozen=True)
class Limits:
    """Range of a number: `low <= x <= high`, or `low < x <= high` if `low_open`."""

    low: float
    high: float = _LARGEST_FLOAT
    low_open: bool = False

    def contain(self, value: Any) -> bool:
        """Whether a number is in range; never true for NaN and infinities."""
        # Numbers closer to zero reach the plugin as zero.
        above = value >= self.low + _SMALLEST_FLOAT if self.low_open else value >= self.low
        return bool(above and value <= self.high)

    def __str__(self) -> str:
        high = str(self.high) if isinstance(self.high, int) else f"{self.high:.2g}"
        if not self.low_open:
            return f"from {self.low:g} to {high}"
        return f"above {self.low or 'zero'}, at most {high}"


_LENGTHS = Limits(0, low_open=True)
_SIZES = (
    "a percentage of the bounding box diagonal such as 5%, mean edges such as 6e, or a length such "
    "as 0.02"
)
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
        if self.automatic:
            return
        if not isinstance(self.value, Real) or not _LENGTHS.contain(self.value):
            raise OptionError(f"{self}: must be {_LENGTHS}, {_SIZES}")
        if self.unit == "%" and self.value > 100:
            raise OptionError(f"{self}: a percentage goes up to 100% of the diagonal")

    @classmethod
    def parse(cls, text: str) -> Length:
        """Parse `5%` (of the diagonal), `6e` (mean edges), `0.02` (a length), or `auto`.

        Raises
        ------
        OptionError
            When `text` is none of these, or not positive.
        """
        number = text.strip()
        if number == "auto":
            return cls(automatic=True)
        unit: Unit = "%" if number.endswith("%") else "e" if number.endswith("e") else ""
        try:
            value = float(number.removesuffix(unit))
        except ValueError:
            raise OptionError(f"{text!r}: give {_SIZES}") from None
        return cls(value, unit)

    def in_units_of_mesh(self, diagonal: float, mean_edge: float) -> float:
        """Convert to the units of `diagonal` and `mean_edge`; auto is the default feature size."""
        if self.automatic:
            return min(6 * mean_edge or diagonal, diagonal / 20)
        return self.value * {"": 1.0, "%": diagonal / 100, "e": mean_edge}[self.unit]

    def __str__(self) -> str:
        if self.automatic:
            return "auto"
        number = f"{self.value:.12g}" if isinstance(self.value, Real) else repr(self.value)
        return number + self.unit


def option(
    default: Any,
    explanation: str,
    limits: Limits | None = None,
    flags: Sequence[str] = (),
    metavar: str | None = None,
) -> Any:
    """Make a field of a table of options.

    Parameters
    ----------
    default, explanation, limits
        Its default, help, and range if it is a number.
    flags, metavar
        How a command spells the option, unless like its name, and what it calls the value.
    """
    metadata = {"help": explanation, "limits": limits, "flags": flags, "metavar": metavar}
    return field(default=default, metadata=metadata)


_NAMED = {
    int: "an integer",
    float: "a number",
    bool: "true or false",
    str: "a text",
    Length: "a length",
}


def _is_of(value: Any, wanted: type) -> bool:
    """Whether a value has a type; integers pass as floats, as in a recipe."""
    if wanted is float:
        return isinstance(value, int | float) and not isinstance(value, bool)
    if wanted is int:
        return isinstance(value, Integral) and not isinstance(value, bool)
    return type(value) is wanted


def _is_text_or_number(value: Any) -> bool:
    return isinstance(value, str | Real) and not isinstance(value, bool)


@functools.cache  # evaluating the annotations takes as long as filtering a small mesh
def _types_of(table: type[Any]) -> dict[str, Any]:
    return get_type_hints(table)


@dataclass(frozen=True, kw_only=True)
class Options:
    """Base of the tables of options, frozen dataclasses whose fields are made by `option`.

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
        table: Any = type(self)  # hashable, which mypy denies
        types = _types_of(table)
        for one in fields(self):
            value = getattr(self, one.name)
            if type(value).__name__ == "PercentageValue":  # of pymeshlab
                value = f"{value.value()}%"
            if types[one.name] is Length and _is_text_or_number(value):
                try:
                    value = Length.parse(str(value))
                except OptionError as error:
                    raise OptionError(f"{one.name} = {error}") from None
                object.__setattr__(self, one.name, value)  # frozen for everybody else
            choices = get_args(types[one.name])
            if choices and value not in choices:
                raise OptionError(f"{one.name} = {value}: choose {', '.join(choices)}")
            wanted = types[one.name]
            if not choices and not _is_of(value, wanted):
                raise OptionError(f"{one.name} = {value!r}: must be {_NAMED[wanted]}")
            if wanted is int:  # it may be a NumPy integer
                object.__setattr__(self, one.name, int(value))
            default: Any = one.default
            is_automatic = isinstance(value, Length) and value.automatic
            if is_automatic and not default.automatic:
                raise OptionError(f"{one.name} = auto: cannot be automatic, give a length")
            limits: Limits | None = one.metadata["limits"]
            if limits is not None and not limits.contain(value):
                raise OptionError(f"{one.name} = {value}: must be {limits}")

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
        """Return the options of a call, given as one object or by name.

        Raises
        ------
        OptionError
            When both are given, or the object is for another filter.
        """
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
        """Return the values for `running.run`; default lengths are left out."""
        parameters = {one.name: getattr(self, one.name) for one in fields(self)}
        for one in fields(self):
            value = parameters[one.name]
            if not isinstance(value, Length):
                continue
            if value.automatic or value == one.default:
                del parameters[one.name]  # chosen by the core to suit the mesh
            else:
                length = float(value.value)
                parameters[one.name] = f"{length!r}{value.unit}" if value.unit else length
        return parameters


def checked_count(name: str, value: Any, least: int = 1) -> int:
    """Return a count as an int; raise OptionError unless it is an integer >= `least`."""
    limits = Limits(least, LARGEST_INTEGER)
    if not isinstance(value, Integral) or isinstance(value, bool) or not limits.contain(value):
        raise OptionError(f"{name} = {value}: must be an integer {limits}")
    return int(value)
