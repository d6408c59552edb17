"""The fractional filter's options: names, defaults, limits, help.

`FilterOptions` is their only definition: the command line, recipes and calls of pymeshlab derive
from it. A test compares its names, choices and defaults with those of the plugin.
"""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral
from typing import Any, Literal, TypedDict

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.option_types import LARGEST_INTEGER, Length, Limits, Options, option
from meshlab_spectral.plugin.loading import FILTER_NAME

FilterType = Literal["low-pass", "high-pass", "band-pass", "band-stop", "custom"]
Response = Literal["gaussian", "butterworth", "ideal"]
BasisUpdate = Literal["full", "conformal", "none"]
Spectrum = Literal["full", "truncated"]
LaplacianKind = Literal["intrinsic delaunay", "cotangent", "uniform"]
Boundary = Literal["free", "fixed"]
Weight = Literal["none", "vertex quality"]
Result = Literal["filtered shape", "details"]
Size = Length | str | float


class TransferKeywords(TypedDict, total=False):
    """The fields of `FilterOptions` that define the transfer function and the Laplacian."""

    filter_type: FilterType
    feature_size: Size
    pass_gain: float
    stop_gain: float
    transfer_function: str
    band_width: float
    response: Response
    order: int
    power: float
    laplacian: LaplacianKind
    boundary: Boundary


class FilterKeywords(TransferKeywords, total=False):
    """All fields of `FilterOptions`."""

    selected: bool
    steps: int
    tolerance: Size
    passes: int
    basis_update: BasisUpdate
    conformal_share: float
    spectrum: Spectrum
    basis_size: int
    reinject_residual: bool
    crease_angle: float
    preserve_volume: bool
    weight: Weight
    result: Result


def checked_count(name: str, value: Any, least: int = 1) -> int:
    """Return a count as an int; raise OptionError unless it is an integer >= `least`."""
    limits = Limits(least, LARGEST_INTEGER)
    if not isinstance(value, Integral) or isinstance(value, bool) or not limits.contain(value):
        raise OptionError(f"{name} = {value}: must be an integer {limits}")
    return int(value)


@dataclass(frozen=True, kw_only=True)
class FilterOptions(Options):
    """Options of the filter, with the names and defaults they have in MeshLab.

    Raises
    ------
    OptionError
        When a value is invalid; names the option, the value and what is allowed.
    """

    FILTER = FILTER_NAME
    TABLE = "filter"

    filter_type: FilterType = option(
        "low-pass",
        "What to do with details: low-pass keeps the large ones and smooths away the rest; "
        "high-pass acts on the small ones (sharpen with --stop-gain 1 --pass-gain 2); band-pass "
        "and band-stop act on details of about the feature size; custom takes --transfer-function.",
    )
    feature_size: Length = option(
        Length(automatic=True),
        "Size of the details at the filter's cutoff: a percentage of the model's diagonal such as "
        "5%, mean edge lengths such as 6e, a length in the model's units such as 0.02, or auto: "
        "6e, at most 5%, where a low-pass keeps thinner parts. Try four times the width of what "
        "you want to remove.",
    )
    pass_gain: float = option(
        1.0, "Factor for the details that pass: 1 keeps them, 2 doubles their height.", Limits(0)
    )
    stop_gain: float = option(
        0.0, "Factor for all other details: 0 removes them, 0.5 halves their height.", Limits(0)
    )
    transfer_function: str = option(
        "20%:1, 5%:2, 1%:0.1",
        "For --filter-type custom: gains at feature sizes as size:gain, with sizes such as 5% of "
        "the diagonal, 6e (mean edges) or 0.02, as on an equalizer; or an expression of w, the "
        "feature size over the wavelength, such as '1/(1 + w^4)'.",
    )
    band_width: float = option(
        1.0,
        "Width of a band in octaves: 1 means that its largest details are twice the size of its "
        "smallest.",
        Limits(0, low_open=True),
    )
    response: Response = option(
        "gaussian",
        "How sharply sizes are separated: gaussian is gentle, butterworth is sharper with a higher "
        "--order, ideal cuts off abruptly and may leave ripples.",
    )
    order: int = option(
        2, "Steepness of the butterworth response: 1 is gentle, 8 is steep.", Limits(1, 64)
    )
    power: float = option(
        1.0,
        "Fractional power of the filter to apply: with 0.5, half of it, a gain of 4 becomes 2.",
        Limits(0, 1, low_open=True),
    )
    selected: bool = option(
        False,
        "Filter only the selected faces and vertices, fading out around them within about a "
        "feature size.",
    )
    steps: int = option(
        0,
        "Apply the filter in this many weak steps, so that thin parts leave no spikes: 0 "
        "approximates infinitely many, 10 is the paper's scheme, 1 the classical one-shot filter.",
        Limits(0, LARGEST_INTEGER),
    )
    tolerance: Length = option(
        Length(0.05, "%"),
        "With --steps 0: maximum distance of the surface from the limit of infinitely many steps, "
        "e.g. 0.05% of the diagonal.",
    )
    passes: int = option(
        0,
        "With --steps 0: the number of passes of 1, 2, 4, ... steps, whatever the tolerance. With "
        "the number in its report, a run is repeated exactly; 0 takes as many as --tolerance "
        "requires.",
        Limits(0, 9),
    )
    basis_update: BasisUpdate = option(
        "conformal",
        "What each step recomputes from the current shape: its areas (conformal; thin parts are "
        "drawn in smoothly), the whole Laplacian (full; the paper's scheme), nothing (none).",
    )
    conformal_share: float = option(
        0.0,
        "Blends the full update (0, the paper's) with the conformal one (1); 0.1 draws in thin "
        "parts that a strong full update leaves as spikes.",
        Limits(0, 1),
    )
    spectrum: Spectrum = option(
        "full", "full filters every detail; truncated only the largest ones, as older methods do."
    )
    basis_size: int = option(
        300, "Number of harmonics in a truncated spectrum, e.g. 300.", Limits(1, LARGEST_INTEGER)
    )
    reinject_residual: bool = option(
        True, "Keep the details beyond a truncated spectrum instead of dropping them."
    )
    laplacian: LaplacianKind = option(
        "intrinsic delaunay",
        "Laplacian that defines the frequencies: 'intrinsic delaunay' is stable with any triangle, "
        "cotangent is the paper's and needs triangles with an area, uniform looks at the "
        "connections only, as if vertices were evenly spaced.",
    )
    boundary: Boundary = option(
        "free",
        "Boundary of an open surface, holes included: free lets it move like the rest, so strong "
        "smoothing draws it in; fixed keeps it exactly in place.",
    )
    crease_angle: float = option(
        0.0,
        "Edges whose faces meet at more than this angle in degrees, e.g. 40, stay in place, and "
        "nothing is smoothed across them; 0 is off.",
        Limits(0, 180),
    )
    preserve_volume: bool = option(
        False,
        "Move the surface along its normals until every closed component has regained its volume.",
    )
    weight: Weight = option(
        "none",
        "'vertex quality': how much of the filter each vertex gets, from 0 (nothing) to 1 (all).",
    )
    result: Result = option(
        "filtered shape",
        "details leaves the shape as it is, and stores what the filter takes away: input minus "
        "result as the vertex attribute spectral_details, and along the normal, positive outwards, "
        "as vertex quality. Files: .ply only.",
    )


@dataclass(frozen=True, kw_only=True)
class SpectrumOptions(Options):
    """Options of `geometry_spectrum`."""

    FILTER = "get_geometry_spectrum"
    TABLE = "spectrum"

    basis_size: int = option(
        0, "Number of lowest harmonics to measure one by one as well.", Limits(0, LARGEST_INTEGER)
    )
    laplacian: LaplacianKind = option("intrinsic delaunay", "As for the filter.")
    boundary: Boundary = option(
        "free",
        "Whether the boundary of an open surface is part of the shape (free) or left out (fixed).",
    )


@dataclass(frozen=True, kw_only=True)
class BasisOptions(Options):
    """Options of `manifold_harmonics`."""

    FILTER = "compute_scalar_manifold_harmonic_per_vertex"
    TABLE = "basis"

    basis_size: int = option(
        100,
        "Number of harmonics, constants included.",
        Limits(1, LARGEST_INTEGER),
        flags=("--basis-size", "-k"),
    )
    laplacian: LaplacianKind = option("intrinsic delaunay", "As for the filter.")
    boundary: Boundary = option(
        "free", "At the boundary of an open surface: free, or fixed to zero."
    )
