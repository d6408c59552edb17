"""The options of the filters: names, defaults, limits, help.

Written by python/write_options.py from the tables in plugin/core/contract: edit those.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypedDict

from meshlab_spectral.filters.option_types import LARGEST_INTEGER, Length, Limits, Options, option

if TYPE_CHECKING:
    from typing_extensions import Unpack

FilterType = Literal["low-pass", "high-pass", "band-pass", "band-stop", "custom"]
Response = Literal["gaussian", "butterworth", "ideal"]
BasisUpdate = Literal["full", "conformal", "none"]
Spectrum = Literal["full", "truncated"]
LaplacianKind = Literal["intrinsic delaunay", "cotangent", "uniform"]
Boundary = Literal["free", "fixed"]
Weight = Literal["none", "vertex quality"]
Result = Literal["filtered shape", "details"]
Form = Literal["size", "none", "plane", "sphere", "cylinder"]
Size = Length | str | float


class TransferKeywords(TypedDict, total=False):
    """Fields of `FilterOptions`, by name."""

    filter_type: FilterType
    feature_size: Size
    power: float
    pass_gain: float
    stop_gain: float
    transfer_function: str
    band_width: float
    response: Response
    order: int
    laplacian: LaplacianKind
    boundary: Boundary


class ShapeKeywords(TransferKeywords, total=False):
    """Fields of `FilterOptions`, by name."""

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
    max_displacement: Size
    weight: Weight


class FilterKeywords(ShapeKeywords, total=False):
    """Fields of `FilterOptions`, by name."""

    result: Result


class DenoiseKeywords(TypedDict, total=False):
    """Fields of `DenoiseOptions`, by name."""

    strength: float
    noise_height: Size
    noise_size: Size
    selected: bool
    keep_creases: bool
    max_displacement: Size
    weight: Weight
    boundary: Boundary
    store_noise_height: bool


class SpectrumKeywords(TypedDict, total=False):
    """Fields of `SpectrumOptions`, by name."""

    basis_size: int
    laplacian: LaplacianKind
    boundary: Boundary


class TextureKeywords(TypedDict, total=False):
    """Fields of `TextureOptions`, by name."""

    waviness: Size
    noise: Size
    form: Form
    form_size: Size
    crease_angle: float
    selected: bool
    laplacian: LaplacianKind


class BasisKeywords(TypedDict, total=False):
    """Fields of `BasisOptions`, by name."""

    basis_size: int
    laplacian: LaplacianKind
    boundary: Boundary


@dataclass(frozen=True, kw_only=True)
class FilterOptions(Options):
    """Options of Spectral Filter (Fractional), named as in MeshLab.

    Raises
    ------
    OptionError
        When a value is invalid; names the option, the value and what is allowed.
    """

    FILTER = "apply_coord_spectral_filter_fractional"
    TABLE = "filter"

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[FilterKeywords]) -> None: ...

    filter_type: FilterType = option(
        "low-pass",
        "Which details to change, by their size: low-pass keeps those larger than the "
        "feature size and removes the rest; high-pass acts on smaller ones (with "
        "--stop-gain 1 and --pass-gain 2 it sharpens); band-pass acts on details of about "
        "the feature size (with --stop-gain 1 and --pass-gain above 1 it enhances them), "
        "band-stop removes them; custom takes the --transfer-function.",
    )
    feature_size: Length = option(
        Length(automatic=True),
        "Size at which the filter cuts off: a wavelength along the surface, that is, a bump "
        "and the hollow next to it. A low-pass leaves a quarter of the height of waves half "
        "as long, and nine tenths of that of waves twice as long. To remove bumps, try four "
        "times their width. At the default size a low-pass removes the noise of a scan, and "
        "thinner parts, such as fingers and wires, keep their thickness; at any other size "
        "they shrink. Default: six mean edges, at most 5 % of the diagonal.",
    )
    power: float = option(
        1.0,
        "Fraction of the filter to apply, as a power of its gains: 0.5 is half strength (a "
        "gain of 4 becomes 2).",
        Limits(0, 1, low_open=True),
    )
    pass_gain: float = option(
        1.0,
        "Factor for the details that the filter passes: 1 keeps them, 2 doubles their "
        "height, 0 removes them.",
        Limits(0),
    )
    stop_gain: float = option(
        0.0,
        "Factor for all other details: 0 removes them, 0.5 halves their height, 1 keeps them.",
        Limits(0),
    )
    transfer_function: str = option(
        "20%:1, 5%:2, 1%:0.1",
        "For the type custom: gains at feature sizes, like an equalizer, as size:gain with "
        "sizes in percent of the diagonal (5%), mean edges (6e) or as lengths; or an "
        "expression of w, the feature size over the wavelength, such as 1/(1 + w^4) (f is "
        "the frequency, l = f^2).",
    )
    band_width: float = option(
        1.0,
        "Width of the band for band-pass and band-stop, in octaves: with 1, its largest "
        "details are twice as large as its smallest.",
        Limits(0, low_open=True),
    )
    response: Response = option(
        "gaussian",
        "How sharply the filter separates sizes: gaussian is gradual and never rings; "
        "butterworth is sharper the higher its --order; ideal cuts off abruptly and may "
        "leave ripples.",
    )
    order: int = option(
        2,
        "Steepness of the butterworth response, from 1 (gentle) to 64 (nearly ideal).",
        Limits(1, 64),
    )
    selected: bool = option(
        False,
        "Filter only the selected faces and vertices. Around them the filter fades out "
        "within about a feature size, so that no crease is left; everything beyond is "
        "unchanged.",
    )
    steps: int = option(
        0,
        "The filter is applied in this many weak steps, because a single strong one turns "
        "thin parts into spikes or balloons. 0 approximates infinitely many of them, to the "
        "--tolerance; 10 is the scheme of the paper with ten steps; 1 is the classical "
        "one-shot filter.",
        Limits(0, 1000),
    )
    tolerance: Length = option(
        Length(0.05, "%"),
        "With --steps 0: largest distance between the result and that of infinitely many "
        "steps, on all but a thousandth of the surface. Larger is faster. Default: 0.05 % "
        "of the diagonal.",
    )
    passes: int = option(
        0,
        "With --steps 0: the number of passes of 1, 2, 4, ... steps, whatever the "
        "--tolerance. The report says how many a run took: that number repeats the run "
        "exactly.",
        Limits(0, 9),
    )
    basis_update: BasisUpdate = option(
        "conformal",
        "What every step recomputes from the current shape. full, the paper's scheme: all "
        "of its frequencies. conformal: its areas only (Kazhdan et al. 2012); thin parts "
        "are drawn in smoothly instead of turning into spikes. none: nothing; the number of "
        "steps then makes no difference.",
    )
    conformal_share: float = option(
        0.0,
        "For the full update: from 0, the paper's scheme, to 1, the conformal update. 0.1 "
        "is enough to contract thin parts that a strong full update leaves as hair-thin "
        "spikes.",
        Limits(0, 1),
    )
    spectrum: Spectrum = option(
        "full",
        "full filters all frequencies of the mesh, and is fast. truncated computes only the "
        "lowest frequencies (as many as the --basis-size) and treats all others alike, as "
        "older methods do; every step takes long, so set a number of --steps, e.g. 10.",
    )
    basis_size: int = option(
        300,
        "Number of frequencies (manifold harmonics) of a truncated spectrum, e.g. 300. Must "
        "be below the number of vertices; time and memory grow with it.",
        Limits(1, LARGEST_INTEGER),
    )
    reinject_residual: bool = option(
        True,
        "For a truncated spectrum: keep the details beyond the basis, with the mean gain of "
        "their frequencies. Off: drop them.",
    )
    laplacian: LaplacianKind = option(
        "intrinsic delaunay",
        "How the frequencies of the surface are measured. intrinsic delaunay works on any "
        "triangles, including slivers, holes, duplicate or intersecting sheets, and is "
        "stable for strong filters. cotangent is the formula of the paper; no triangle may "
        "have zero area. uniform uses the connectivity only, as if the vertices were evenly "
        "spaced: for noise that differs from vertex to vertex.",
    )
    boundary: Boundary = option(
        "free",
        "The boundary of an open surface, holes included. free: it moves like the rest; "
        "strong smoothing rounds it off and pulls it in. fixed: it stays exactly in place, "
        "and the surface in between is filtered.",
    )
    crease_angle: float = option(
        0.0,
        "Edges whose two faces meet at more than this angle, in degrees, stay in place, and "
        "nothing is filtered across them. For the edges of a machine part, e.g. 40.",
        Limits(0, 180),
    )
    preserve_volume: bool = option(
        False,
        "Move the surface along its normals until every closed component has regained its "
        "volume. Open components have none.",
    )
    max_displacement: Length = option(
        Length(automatic=True),
        "No vertex moves farther than this. Around vertices that would, the surface moves "
        "less, too, so that no ridge is left; the report says on how much of it. The "
        "default: no bound.",
    )
    weight: Weight = option(
        "none",
        "vertex quality: how much of the filter each vertex gets, from 0 (nothing) to 1 "
        "(all), so that you can paint where to filter. none: all of it.",
    )
    result: Result = option(
        "filtered shape",
        "details: no vertex moves. What the filter would remove, input minus result, is "
        "stored as the vertex attribute spectral_details, and its length along the normal, "
        "positive outwards, replaces the vertex quality (after it has served as the "
        "weight).",
    )


@dataclass(frozen=True, kw_only=True)
class DenoiseOptions(Options):
    """Options of Spectral Denoise, named as in MeshLab.

    Raises
    ------
    OptionError
        When a value is invalid; names the option, the value and what is allowed.
    """

    FILTER = "apply_coord_spectral_denoise"
    TABLE = "denoise"

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[DenoiseKeywords]) -> None: ...

    strength: float = option(
        1.0,
        "1 removes the noise as measured. More also removes fine details; less leaves some "
        "noise; 0 changes nothing.",
        Limits(0),
    )
    noise_height: Length = option(
        Length(automatic=True),
        "Standard deviation of the noise along the normals, such as 0.2e. Set it if details "
        "were mistaken for noise, or noise for details. The default: as measured, which the "
        "report states.",
    )
    noise_size: Length = option(
        Length(automatic=True),
        "Distance over which the noise is correlated: half the width of its bumps, such as "
        "2e. Noise of up to one mean edge is independent at each vertex. The default: as "
        "measured.",
    )
    selected: bool = option(
        False,
        "Filter only the selected faces and vertices. Around them the filter fades out "
        "within four edges, so that no crease is left; everything beyond is unchanged.",
    )
    keep_creases: bool = option(
        True, "Do not smooth across creases. Off: creases are rounded; for shapes without any."
    )
    max_displacement: Length = option(
        Length(automatic=True),
        "No vertex moves farther than this. Around vertices that would, the surface moves "
        "less, too, so that no ridge is left; the report says on how much of it. The "
        "default: no bound.",
    )
    weight: Weight = option(
        "none",
        "vertex quality: factor on the --noise-height at each vertex, from 0 (no noise) to "
        "1, for noise that varies over the surface. none: as measured, or the same "
        "everywhere.",
    )
    boundary: Boundary = option(
        "free",
        "The boundary of an open surface, holes included. free: it moves along its normals, "
        "no further than the noise explains. fixed: it stays exactly in place.",
    )
    store_noise_height: bool = option(
        False,
        "Store the height of the noise found at each vertex, 0 where there is none, as the "
        "vertex attribute noise_height.",
    )


@dataclass(frozen=True, kw_only=True)
class SpectrumOptions(Options):
    """Options of Geometry Spectrum, named as in MeshLab.

    Raises
    ------
    OptionError
        When a value is invalid; names the option, the value and what is allowed.
    """

    FILTER = "get_geometry_spectrum"
    TABLE = "spectrum"

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[SpectrumKeywords]) -> None: ...

    basis_size: int = option(
        0,
        "Number of the largest features (manifold harmonics, constant ones included) that "
        "are also computed individually, for scripts that need them; this takes most of the "
        "time. The octaves cover all features in any case. On a small mesh, all harmonics "
        "are computed.",
        Limits(0, LARGEST_INTEGER),
    )
    laplacian: LaplacianKind = option(
        "intrinsic delaunay",
        "How the frequencies of the surface are measured. intrinsic delaunay works on any "
        "triangles, including slivers, holes, duplicate or intersecting sheets, and is "
        "stable for strong filters. cotangent is the formula of the paper; no triangle may "
        "have zero area. uniform uses the connectivity only, as if the vertices were evenly "
        "spaced: for noise that differs from vertex to vertex.",
    )
    boundary: Boundary = option(
        "free",
        "The boundary of an open surface, holes included. free: it is part of the shape. "
        "fixed: only the details that it does not determine are measured.",
    )


@dataclass(frozen=True, kw_only=True)
class TextureOptions(Options):
    """Options of Surface Texture, named as in MeshLab.

    Raises
    ------
    OptionError
        When a value is invalid; names the option, the value and what is allowed.
    """

    FILTER = "compute_scalar_surface_texture_per_vertex"
    TABLE = "texture"

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[TextureKeywords]) -> None: ...

    waviness: Length = option(
        Length(automatic=True),
        "Nesting index of the L-filter of ISO 25178-3: what is larger is waviness or form, "
        "not roughness. Waves of this length keep half of their height, as in ISO 16610-61. "
        "With a plane, sphere or cylinder as --form, the whole diagonal means no L-filter. "
        "Default: twelve mean edges, at most 10 % of the diagonal.",
        flags=("--waviness", "--nesting-index-l"),
    )
    noise: Length = option(
        Length(automatic=True),
        "Nesting index of the S-filter: what is smaller is noise, not roughness. The "
        "default: nothing is removed.",
        flags=("--noise", "--nesting-index-s"),
    )
    form: Form = option(
        "size",
        "What counts as form (F-operator), not as roughness. size: heights that vary more "
        "slowly than --form-size; suits any shape. plane, sphere, cylinder: the one nearest "
        "to the measured surface, by least squares; better for a sphere or a cylinder with "
        "a radius of less than two waviness cutoffs. none: nothing, so that curvature adds "
        "to the heights.",
    )
    form_size: Length = option(
        Length(automatic=True),
        "For --form size: heights that vary more slowly are form. The default: eight times "
        "--waviness.",
    )
    crease_angle: float = option(
        50.0,
        "Edges between faces whose planes differ by more than this are creases, if the form "
        "turns as much. The surface within a waviness cutoff of them, and of boundaries, is "
        "left out: it gets the height 0. Holes of up to a quarter of a cutoff count as "
        "missing points: nothing is left out around them. With 180 no edge is a crease; a "
        "plane, sphere or cylinder has none.",
        Limits(0, 180),
    )
    selected: bool = option(
        False,
        "Measure only the selected faces and vertices; the others have the height 0. A "
        "plane, sphere or cylinder is fitted to them alone.",
    )
    laplacian: LaplacianKind = option(
        "intrinsic delaunay",
        "How the frequencies of the surface are measured. intrinsic delaunay works on any "
        "triangles, including slivers, holes, duplicate or intersecting sheets, and is "
        "stable for strong filters. cotangent is the formula of the paper; no triangle may "
        "have zero area. uniform uses the connectivity only, as if the vertices were evenly "
        "spaced: for noise that differs from vertex to vertex.",
    )


@dataclass(frozen=True, kw_only=True)
class BasisOptions(Options):
    """Options of Manifold Harmonics, named as in MeshLab.

    Raises
    ------
    OptionError
        When a value is invalid; names the option, the value and what is allowed.
    """

    FILTER = "compute_scalar_manifold_harmonic_per_vertex"
    TABLE = "basis"

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[BasisKeywords]) -> None: ...

    basis_size: int = option(
        100,
        "Number of harmonics to compute, constant ones included. Must be below the number "
        "of vertices that are not fixed; time and memory grow with it.",
        Limits(1, LARGEST_INTEGER),
        flags=("--basis-size", "-k"),
    )
    laplacian: LaplacianKind = option(
        "intrinsic delaunay",
        "How the frequencies of the surface are measured. intrinsic delaunay works on any "
        "triangles, including slivers, holes, duplicate or intersecting sheets, and is "
        "stable for strong filters. cotangent is the formula of the paper; no triangle may "
        "have zero area. uniform uses the connectivity only, as if the vertices were evenly "
        "spaced: for noise that differs from vertex to vertex.",
    )
    boundary: Boundary = option(
        "free",
        "The boundary of an open surface, holes included. free: the waves have zero slope "
        "across the boundary. fixed: they are zero there, like the skin of a drum.",
    )
