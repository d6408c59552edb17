"""The one table of the filter's options: names, defaults, limits, help.

The command line, batch recipes and calls of pymeshlab all take theirs from `FilterOptions`; a test
asserts that its names, choices and defaults are those of the plugin.
"""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass, field, fields
from typing import Any, Literal, get_args, get_type_hints

from meshlab_spectral.errors import OptionError

FilterType = Literal["low-pass", "high-pass", "band-pass", "band-stop"]
Response = Literal["gaussian", "butterworth", "ideal"]
BasisUpdate = Literal["full", "conformal", "none"]
Spectrum = Literal["full", "truncated"]
LaplacianKind = Literal["intrinsic delaunay", "cotangent"]
Boundary = Literal["free", "fixed"]


@dataclass(frozen=True)
class Length:
    """A length in the units of the mesh, or as a percentage of the diagonal of its bounding box.

    Attributes
    ----------
    value
        Percent where `relative`, else a length in the units of the mesh; above 0, finite.
    relative
        Whether `value` is a percentage.
    automatic
        Whether the filter chooses the length that suits the mesh; `value` is then without meaning.
    """

    value: float = 0.0
    relative: bool = False
    automatic: bool = False

    def __post_init__(self) -> None:
        if self.automatic:
            return
        if not (math.isfinite(self.value) and self.value > 0):
            raise OptionError(
                f"{self}: must be above zero, a percentage of the diagonal of the bounding box "
                "such as 5%, or a length such as 0.02"
            )
        if self.relative and self.value > 100:
            raise OptionError(
                f"{self}: a percentage of the diagonal goes up to 100%; give a length for more"
            )

    @classmethod
    def parse(cls, text: str) -> Length:
        """Read `5%` as a percentage of the diagonal, `0.02` as a length, `auto` as automatic.

        Raises
        ------
        OptionError
            When `text` is neither, or not above zero.
        """
        number = text.strip()
        if number == "auto":
            return cls(automatic=True)
        relative = number.endswith("%")
        try:
            value = float(number.removesuffix("%"))
        except ValueError:
            raise OptionError(
                f"{text!r}: give a percentage of the diagonal of the bounding box such as 5%, or a "
                "length such as 0.02"
            ) from None
        return cls(value, relative)

    def __str__(self) -> str:
        return "auto" if self.automatic else f"{self.value:.12g}{'%' if self.relative else ''}"


@dataclass(frozen=True)
class Limits:
    """Numbers that an option may have: `low <= x <= high`, or `low < x <= high` if `low_open`."""

    low: float
    high: float = math.inf
    low_open: bool = False

    def contain(self, value: float) -> bool:
        """Whether a value lies within; never for NaN and infinities."""
        above = value > self.low if self.low_open else value >= self.low
        return math.isfinite(value) and above and value <= self.high

    def __str__(self) -> str:
        if math.isfinite(self.high) and not self.low_open:
            return f"from {self.low:g} to {self.high:g}"
        low = f"{'above' if self.low_open else 'at least'} {self.low:g}"
        return f"{low}, at most {self.high:g}" if math.isfinite(self.high) else low


def _option(default: Any, explanation: str, limits: Limits | None = None) -> Any:
    return field(default=default, metadata={"help": explanation, "limits": limits})


def _is_of(value: Any, wanted: type) -> bool:
    """Whether a value, perhaps of a recipe, has a type; whole numbers pass as floats."""
    if wanted is float:
        return isinstance(value, int | float) and not isinstance(value, bool)
    return type(value) is wanted


@dataclass(frozen=True, kw_only=True)
class FilterOptions:
    """Options of the filter, under the names and with the defaults that it has in MeshLab.

    Raises
    ------
    OptionError
        When a value cannot be what its option takes: it names the option, the value and what is
        allowed.
    """

    filter_type: FilterType = _option(
        "low-pass",
        "What to do with details: low-pass keeps the large ones and smooths the rest away; "
        "high-pass acts on the small ones (sharpen with --stop-gain 1 --pass-gain 2); band-pass "
        "and band-stop act on details of about the feature size.",
    )
    feature_size: Length = _option(
        Length(automatic=True),
        "Size of the details where the filter turns over: 5% of the model's diagonal, a length in "
        "the model's units such as 0.02, or auto: six mean edges, at most 5%. Try twice the width "
        "of what you want to remove.",
    )
    pass_gain: float = _option(
        1.0, "Factor for the details that pass: 1 keeps them, 2 doubles their height.", Limits(0)
    )
    stop_gain: float = _option(
        0.0, "Factor for all other details: 0 removes them, 0.5 halves their height.", Limits(0)
    )
    band_width: float = _option(
        1.0,
        "Width of a band in octaves: 1 means that its largest details are twice as large as its "
        "smallest.",
        Limits(0, low_open=True),
    )
    response: Response = _option(
        "gaussian",
        "How sharply sizes are told apart: gaussian is gentle, butterworth sharper with --order, "
        "ideal cuts at once and may leave ripples.",
    )
    order: int = _option(
        2, "Steepness of the butterworth response: 1 is gentle, 8 is steep.", Limits(1, 64)
    )
    power: float = _option(
        1.0,
        "The part of the filter to apply, as a power of its gains: 0.5 is half of the filter, a "
        "gain of 4 becomes 2.",
        Limits(0, 1, low_open=True),
    )
    steps: int = _option(
        0,
        "Apply the filter as this many weak steps, so that thin parts survive: 0 takes as many as "
        "--tolerance needs, 10 is the paper's scheme with ten, 1 the classical one-shot filter.",
        Limits(0),
    )
    tolerance: Length = _option(
        Length(0.05, relative=True),
        "With 0 steps: how far the surface may be from where infinitely many steps would put it, "
        "e.g. 0.05% of the diagonal.",
    )
    basis_update: BasisUpdate = _option(
        "conformal",
        "What a step learns from the one before: its areas (conformal; thin parts shrink "
        "smoothly), everything (full; the paper's scheme) or nothing (none).",
    )
    conformal_share: float = _option(
        0.0,
        "For the full update: from 0, the paper's, to 1, the conformal one; 0.1 draws in thin "
        "parts that a strong full update leaves as spikes.",
        Limits(0, 1),
    )
    spectrum: Spectrum = _option(
        "full", "full filters every detail; truncated only the largest, as older methods do."
    )
    basis_size: int = _option(
        300, "How many frequencies a truncated spectrum has, e.g. 300.", Limits(1)
    )
    reinject_residual: bool = _option(
        True, "Keep the details beyond a truncated spectrum, or drop them."
    )
    laplacian: LaplacianKind = _option(
        "intrinsic delaunay",
        "How frequencies are measured: 'intrinsic delaunay' works on any triangles and stays "
        "stable; cotangent is the paper's and needs triangles with an area.",
    )
    boundary: Boundary = _option(
        "free",
        "Rims of an open surface and of its holes: free lets them move as the rest does, strong "
        "smoothing draws them in; fixed keeps them exactly where they are.",
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
                raise OptionError(f"{option.name} = {value!r}: must be a {wanted.__name__}")
            if isinstance(value, Length) and value.automatic and option.name != "feature_size":
                raise OptionError(f"{option.name} = auto: only feature_size can be automatic")
            limits: Limits | None = option.metadata["limits"]
            if limits is not None and not limits.contain(value):
                raise OptionError(f"{option.name} = {value}: must be {limits}")

    def as_dict(self) -> dict[str, Any]:
        """All options as plain values: text, numbers, truth values."""
        plain = {option.name: getattr(self, option.name) for option in fields(self)}
        return {
            name: str(value) if isinstance(value, Length) else value
            for name, value in plain.items()
        }

    @classmethod
    def from_dict(cls, plain: dict[str, Any]) -> FilterOptions:
        """Make options from plain values, as `as_dict` gives them; the rest have their default."""
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
                hint = f"did you mean {similar[0]}?" if similar else f"known are {', '.join(known)}"
                raise OptionError(f"there is no option {name}: {hint}")
        return cls(**values)

    def pymeshlab_parameters(self) -> dict[str, Any]:
        """All that the filter is not to choose itself, as pymeshlab's keyword arguments."""
        import pymeshlab

        parameters = self.as_dict()
        for option in fields(self):
            value = getattr(self, option.name)
            if isinstance(value, Length) and value.automatic:
                del parameters[option.name]
            elif isinstance(value, Length):
                kind = pymeshlab.PercentageValue if value.relative else pymeshlab.PureValue
                parameters[option.name] = kind(value.value)
        return parameters
