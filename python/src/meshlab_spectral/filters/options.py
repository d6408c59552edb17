"""The filter's options: names, defaults, limits, help.

`FilterOptions` is the only such table: the command line, recipes and calls of pymeshlab are derived
from it. A test compares its names, choices and defaults with those of the plugin.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass, field, fields
from numbers import Integral, Real
from typing import Any, Literal, get_args, get_type_hints

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import mean_edge

FilterType = Literal["low-pass", "high-pass", "band-pass", "band-stop", "custom"]
Response = Literal["gaussian", "butterworth", "ideal"]
BasisUpdate = Literal["full", "conformal", "none"]
Spectrum = Literal["full", "truncated"]
LaplacianKind = Literal["intrinsic delaunay", "cotangent", "uniform"]
Boundary = Literal["free", "fixed"]
Weight = Literal["none", "vertex quality"]


# What pymeshlab can pass on: 32-bit integers, and floats of single precision.
_LARGEST_INTEGER = 2**31 - 1
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


def checked_basis_size(value: Any) -> int:
    """Return a basis size as an integer; raise OptionError unless it is one from 1 on."""
    limits = Limits(1, _LARGEST_INTEGER)
    if not isinstance(value, Integral) or isinstance(value, bool) or not limits.contain(value):
        raise OptionError(f"basis_size = {value}: must be an integer {limits}")
    return int(value)


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
            raise OptionError(
                f"{self}: a percentage goes up to 100% of the diagonal; for more, give a length"
            )

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
        """Convert to the units of a mesh, from its lengths in them."""
        return self.value * {"": 1.0, "%": diagonal / 100, "e": mean_edge}[self.unit]

    def __str__(self) -> str:
        if self.automatic:
            return "auto"
        number = f"{self.value:.12g}" if isinstance(self.value, Real) else repr(self.value)
        return number + self.unit


def _option(default: Any, explanation: str, limits: Limits | None = None) -> Any:
    return field(default=default, metadata={"help": explanation, "limits": limits})


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
    return type(value) is wanted


@dataclass(frozen=True, kw_only=True)
class FilterOptions:
    """Options of the filter, with the names and defaults they have in MeshLab.

    Raises
    ------
    OptionError
        When a value is invalid; names the option, the value and what is allowed.
    """

    filter_type: FilterType = _option(
        "low-pass",
        "What to do with details: low-pass keeps the large ones and smooths away the rest; "
        "high-pass acts on the small ones (sharpen with --stop-gain 1 --pass-gain 2); band-pass "
        "and band-stop act on details of about the feature size; custom takes --transfer-function.",
    )
    feature_size: Length = _option(
        Length(automatic=True),
        "Size of the details at the filter's cutoff: a percentage of the model's diagonal such as "
        "5%, mean edge lengths such as 6e, a length in the model's units such as 0.02, or auto: "
        "6e, at most 5%. Try twice the width of what you want to remove.",
    )
    pass_gain: float = _option(
        1.0, "Factor for the details that pass: 1 keeps them, 2 doubles their height.", Limits(0)
    )
    stop_gain: float = _option(
        0.0, "Factor for all other details: 0 removes them, 0.5 halves their height.", Limits(0)
    )
    transfer_function: str = _option(
        "20%:1, 5%:2, 1%:0.1",
        "For --filter-type custom: gains at feature sizes as size:gain, with sizes such as 5% of "
        "the diagonal, 6e (mean edges) or 0.02, as on an equalizer; or an expression of w, the "
        "feature size over the wavelength, such as '1/(1 + w^4)'.",
    )
    band_width: float = _option(
        1.0,
        "Width of a band in octaves: 1 means that its largest details are twice the size of its "
        "smallest.",
        Limits(0, low_open=True),
    )
    response: Response = _option(
        "gaussian",
        "How sharply sizes are separated: gaussian is gentle, butterworth is sharper with a higher "
        "--order, ideal cuts off abruptly and may leave ripples.",
    )
    order: int = _option(
        2, "Steepness of the butterworth response: 1 is gentle, 8 is steep.", Limits(1, 64)
    )
    power: float = _option(
        1.0,
        "Fractional power of the filter to apply: 0.5 is half the filter, a gain of 4 becomes 2.",
        Limits(0, 1, low_open=True),
    )
    selected: bool = _option(
        False,
        "Filter only the selected faces and vertices, fading out around them within about a "
        "feature size.",
    )
    steps: int = _option(
        0,
        "Apply the filter in this many weak steps, so that thin parts survive: 0 takes as many as "
        "--tolerance requires, 10 is the paper's scheme, 1 the classical one-shot filter.",
        Limits(0, _LARGEST_INTEGER),
    )
    tolerance: Length = _option(
        Length(0.05, "%"),
        "With --steps 0: maximum distance of the surface from the limit of infinitely many steps, "
        "e.g. 0.05% of the diagonal.",
    )
    basis_update: BasisUpdate = _option(
        "conformal",
        "What a step takes over from the one before: its areas (conformal; thin parts shrink "
        "smoothly), everything (full; the paper's scheme) or nothing (none).",
    )
    conformal_share: float = _option(
        0.0,
        "Blends the full update (0, the paper's) with the conformal one (1); 0.1 draws in thin "
        "parts that a strong full update leaves as spikes.",
        Limits(0, 1),
    )
    spectrum: Spectrum = _option(
        "full", "full filters every detail; truncated only the largest ones, as older methods do."
    )
    basis_size: int = _option(
        300, "Number of harmonics in a truncated spectrum, e.g. 300.", Limits(1, _LARGEST_INTEGER)
    )
    reinject_residual: bool = _option(
        True, "Keep the details beyond a truncated spectrum instead of dropping them."
    )
    laplacian: LaplacianKind = _option(
        "intrinsic delaunay",
        "Laplacian that defines the frequencies: 'intrinsic delaunay' is stable with any triangle, "
        "cotangent is the paper's and needs triangles with an area, uniform looks at the "
        "connections only, as if vertices were evenly spaced.",
    )
    boundary: Boundary = _option(
        "free",
        "Boundary of an open surface, holes included: free lets it move like the rest, so strong "
        "smoothing draws it in; fixed keeps it exactly in place.",
    )

    crease_angle: float = _option(
        0.0,
        "Edges whose faces meet at more than this angle in degrees, e.g. 40, stay in place and let "
        "nothing across; 0 is off.",
        Limits(0, 180),
    )
    preserve_volume: bool = _option(
        False, "Move the surface along its normals until every closed component has its volume."
    )
    weight: Weight = _option(
        "none",
        "'vertex quality': how much of the filter each vertex gets, from 0 (nothing) to 1 (all).",
    )

    def __post_init__(self) -> None:
        types = get_type_hints(FilterOptions)
        for option in fields(self):
            value = getattr(self, option.name)
            choices = get_args(types[option.name])
            if choices and value not in choices:
                raise OptionError(f"{option.name} = {value}: choose {', '.join(choices)}")
            wanted = types[option.name]
            if not choices and not _is_of(value, wanted):
                raise OptionError(f"{option.name} = {value!r}: must be {_NAMED[wanted]}")
            if isinstance(value, Length) and value.automatic and option.name != "feature_size":
                raise OptionError(f"{option.name} = auto: only feature_size can be automatic")
            limits: Limits | None = option.metadata["limits"]
            if limits is not None and not limits.contain(value):
                raise OptionError(f"{option.name} = {value}: must be {limits}")

    def as_dict(self) -> dict[str, Any]:
        """All options as plain values: strings, numbers, booleans."""
        plain = {option.name: getattr(self, option.name) for option in fields(self)}
        return {
            name: str(value) if isinstance(value, Length) else value
            for name, value in plain.items()
        }

    @classmethod
    def from_dict(cls, plain: dict[str, Any]) -> FilterOptions:
        """Make options from plain values, as from `as_dict`; the rest keep their defaults."""
        values = dict(plain)
        for name, wanted in get_type_hints(cls).items():
            if wanted is Length and name in values:
                try:
                    values[name] = Length.parse(str(values[name]))
                except OptionError as error:
                    raise OptionError(f"{name} = {error}") from None
        known = [option.name for option in fields(cls)]
        for name in values:
            if name not in known:
                similar = difflib.get_close_matches(name, known, n=1)
                hint = f"did you mean {similar[0]}?" if similar else f"choose {', '.join(known)}"
                raise OptionError(f"there is no option {name}: {hint}")
        return cls(**values)

    def pymeshlab_parameters(self, mesh: Any) -> dict[str, Any]:
        """Keyword arguments for pymeshlab; automatic options are left out.

        Parameters
        ----------
        mesh
            The `pymeshlab.Mesh` to filter, which says how long a mean edge is.
        """
        import pymeshlab

        parameters = self.as_dict()
        for option in fields(self):
            value = getattr(self, option.name)
            if not isinstance(value, Length):
                continue
            if value.automatic:
                del parameters[option.name]
            elif value.unit == "%":
                parameters[option.name] = pymeshlab.PercentageValue(value.value)
            else:
                edge = mean_edge(mesh) if value.unit == "e" else 0.0
                length = value.in_units_of_mesh(0.0, edge)
                parameters[option.name] = pymeshlab.PureValue(length)
        return parameters
