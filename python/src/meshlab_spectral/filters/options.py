"""The options of the filters by name, with their types; the core has all else.

Written by python/write_options.py from the tables in plugin/core/contract: edit those.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

from meshlab_spectral.filters.option_types import Length, Options, table_of

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


@table_of("apply_coord_spectral_filter_fractional", "filter")
class FilterOptions(Options):
    """Options of Spectral Filter (Fractional), named as in MeshLab; see `Options`."""

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[FilterKeywords]) -> None: ...

    filter_type: FilterType
    feature_size: Length
    power: float
    pass_gain: float
    stop_gain: float
    transfer_function: str
    band_width: float
    response: Response
    order: int
    selected: bool
    steps: int
    tolerance: Length
    passes: int
    basis_update: BasisUpdate
    conformal_share: float
    spectrum: Spectrum
    basis_size: int
    reinject_residual: bool
    laplacian: LaplacianKind
    boundary: Boundary
    crease_angle: float
    preserve_volume: bool
    max_displacement: Length
    weight: Weight
    result: Result


@table_of("apply_coord_spectral_denoise", "denoise")
class DenoiseOptions(Options):
    """Options of Spectral Denoise, named as in MeshLab; see `Options`."""

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[DenoiseKeywords]) -> None: ...

    strength: float
    noise_height: Length
    noise_size: Length
    selected: bool
    keep_creases: bool
    max_displacement: Length
    weight: Weight
    boundary: Boundary
    store_noise_height: bool


@table_of("get_geometry_spectrum", "spectrum")
class SpectrumOptions(Options):
    """Options of Geometry Spectrum, named as in MeshLab; see `Options`."""

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[SpectrumKeywords]) -> None: ...

    basis_size: int
    laplacian: LaplacianKind
    boundary: Boundary


@table_of(
    "compute_scalar_surface_texture_per_vertex",
    "texture",
    waviness=("--waviness", "--nesting-index-l"),
    noise=("--noise", "--nesting-index-s"),
)
class TextureOptions(Options):
    """Options of Surface Texture, named as in MeshLab; see `Options`."""

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[TextureKeywords]) -> None: ...

    waviness: Length
    noise: Length
    form: Form
    form_size: Length
    crease_angle: float
    selected: bool
    laplacian: LaplacianKind


@table_of("compute_scalar_manifold_harmonic_per_vertex", "basis", basis_size=("--basis-size", "-k"))
class BasisOptions(Options):
    """Options of Manifold Harmonics, named as in MeshLab; see `Options`."""

    if TYPE_CHECKING:

        def __init__(self, **named: Unpack[BasisKeywords]) -> None: ...

    basis_size: int
    laplacian: LaplacianKind
    boundary: Boundary
