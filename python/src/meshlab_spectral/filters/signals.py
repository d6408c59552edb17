"""Filters for scalars and colours at the vertices of a mesh, on arrays."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import isfinite, log, pi, sqrt
from numbers import Real
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import ArgumentError, ArrayError, OptionError
from meshlab_spectral.filters.arrays import mesh_arrays, real_numbers
from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.mesh_objects import array_of, takes_mesh_alone
from meshlab_spectral.filters.options import FilterOptions, TransferKeywords
from meshlab_spectral.filters.progress import Progress, progress_callback
from meshlab_spectral.filters.reports import ColorsReport, ScalarsReport
from meshlab_spectral.filters.representations import Report
from meshlab_spectral.filters.running import Gain, plain, require_no_type, run
from meshlab_spectral.warned import Warned, warned, with_warnings

if TYPE_CHECKING:
    from typing_extensions import Unpack

_SCALARS = "apply_scalar_spectral_filter_per_vertex"
# More than any atlas of brain regions has.
_MOST_LABELS = 1000
# Columns in one run: their share of reading the mesh is small, and so are their copies.
_TOGETHER = 64
_COLORS = "apply_color_spectral_filter_per_vertex"

# A Gaussian of standard deviation s is half as high at s sqrt(2 ln 2): fwhm = 2 sqrt(2 ln 2) s. It
# multiplies waves by exp(-s^2 omega^2 / 2). The low-pass, 2^(-w^2 / 2) with w = feature size omega
# / 2 pi, is the same if s = sqrt(ln 2) feature size / 2 pi: the feature size is 3.20 fwhm.
_SIZE_PER_FWHM = pi / (sqrt(2) * log(2))


@takes_options(FilterOptions, names=TransferKeywords.__annotations__)
@takes_mesh_alone
def filter_scalars(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    values: ArrayLike | None = None,
    options: FilterOptions | None = None,
    *,
    fwhm: float | None = None,
    gain: Gain | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[TransferKeywords],
) -> tuple[NDArray[np.float64], ScalarsReport]:
    """Filter a scalar field on a mesh by the size of its details; the shape stays as it is.

    With A the Laplacian of the mesh and F the transfer function that `filter_mesh` would apply to
    the coordinates, the result is ``F(sqrt(A)) values`` over the whole spectrum. The area-weighted
    mean of every connected component is kept; values are not clamped.

    A size is a string such as "2%" (of the bounding box diagonal) or "6e" (mean edges), or a length
    in the units of the mesh. With boundary="fixed", values on the boundary do not change.

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `filter_mesh`.
    values
        n numbers, or n x k for k fields, each filtered on its own, or the name of such an array in
        the mesh; many together take a fifth of the time that they take one by one. NaN means no
        data: it stays, and the surface ends there for the others. Values at unreferenced vertices
        are kept exactly. Labels would be averaged: filter where each of them is, and take the label
        with most weight (see the example).
    options
        All options below in one object, instead of by name; others must have their defaults.
    fwhm
        Instead of `feature_size`: the width at half height of the Gaussian that the values are
        smoothed with, as in brain imaging; length units, > 0.
    gain, progress, threads
        As for `filter_mesh`.
    **named

    Returns
    -------
    values : array
        The filtered values, in the shape of the input.
    report : ScalarsReport
        A dict. Numbers: `rms_change` over the surface and `max_change`, in the units of the values;
        `error_estimate`, relative to their largest deviation from the means; and others.
        "warnings" lists problems and what to do about them. For n x k values, a list of the k
        reports as "columns".

    Raises
    ------
    SpectralError
        As from `filter_mesh`: an OptionError when an option applies only to shapes, a FilterError
        when a value is infinite, or all are NaN.

    Examples
    --------
    >>> smooth, report = filter_scalars(vertices, faces, curvature, feature_size="2%")
    >>> report["rms_change"], report["max_change"]

    Labels, of which a low-pass takes small islands:

    >>> names, indices = np.unique(labels, return_inverse=True)
    >>> weights, _ = filter_scalars(vertices, faces, np.eye(len(names))[indices])
    >>> smooth = names[weights.argmax(axis=1)]
    """
    V, F = mesh_arrays(mesh_or_vertices, faces)
    if values is None:
        raise ArgumentError("values: pass numbers to filter, one for each vertex")
    if fwhm is not None:
        options, named = _smoothing(fwhm, options, named, gain)
    parameters = _parameters(options, named, gain)
    given_values = array_of(mesh_or_vertices, values, "values")
    Q = real_numbers(given_values, "values")
    if Q.ndim not in (1, 2) or len(Q) != len(V) or Q.size == 0:
        raise ArrayError(
            f"values have shape {Q.shape}: pass {len(V)} numbers, one for each vertex, or a matrix "
            f"with {len(V)} rows"
        )

    labels = _warning_of_labels(np.asarray(given_values))

    filter_ = partial(run, _SCALARS, V, F, parameters, gain=gain, threads=threads)
    fields = Q.reshape(len(V), -1)
    filtered = np.empty_like(fields)
    reports: list[dict[str, Any]] = [{}] * fields.shape[1]
    with progress_callback(progress) as on_progress:
        for block in _filtered_together(fields):
            done = filter_(values=fields[:, block], progress=on_progress)
            filtered[:, block] = done.values
            for j, column in zip(block, done.columns or [done.report], strict=True):
                reports[j] = Report(plain(column))
    if Q.ndim == 2:
        each = [w.of(f"column {j}") for j, one in enumerate(reports) for w in warned(one)]
        together = with_warnings({"columns": reports}, each + labels)
        return filtered, cast(ScalarsReport, Report(together))
    report = with_warnings(reports[0], warned(reports[0]) + labels)
    return filtered[:, 0], cast(ScalarsReport, Report(report))


@takes_options(FilterOptions, names=TransferKeywords.__annotations__)
@takes_mesh_alone
def filter_colors(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    colors: ArrayLike | None = None,
    options: FilterOptions | None = None,
    *,
    gain: Gain | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[TransferKeywords],
) -> tuple[NDArray[Any], ColorsReport]:
    """Filter colours at the vertices: red, green and blue as by `filter_scalars`.

    Parameters
    ----------
    mesh_or_vertices, faces, options, gain, progress, threads
        As for `filter_scalars`.
    colors
        n x 3 or n x 4 integers from 0 to 255, or floating-point numbers from 0 to 1, or the name of
        such an array in the mesh; the fourth channel, alpha, is kept.
    **named

    Returns
    -------
    colors : array
        The filtered levels, in the shape and range of the input: integers as uint8, clamped and
        rounded; floating-point numbers in steps of 1/255, as MeshLab stores them.
    report : ColorsReport
        A dict, as from `filter_scalars`, with changes in levels, and `clamped_values`.
    """
    V, F = mesh_arrays(mesh_or_vertices, faces)
    if colors is None:
        raise ArgumentError("colors: pass red, green and blue of each vertex")
    parameters = _parameters(options, named, gain)
    given_colors = array_of(mesh_or_vertices, colors, "colors")
    real_numbers(given_colors, "colors")
    C = np.asarray(given_colors)
    most = 1 if np.issubdtype(C.dtype, np.floating) else 255
    if C.shape not in ((len(V), 3), (len(V), 4)) or not ((C >= 0) & (most >= C)).all():
        raise ArrayError(
            f"colors: pass {len(V)} x 3 or {len(V)} x 4 integers from 0 to 255, or floating-point "
            "numbers from 0 to 1"
        )
    levels = np.round(C[:, :3] * (255 / most)).astype(np.float64)
    filter_ = partial(run, _COLORS, V, F, parameters, gain=gain, threads=threads)
    done = filter_(values=levels, progress=progress)
    assert done.values is not None
    filtered = C.astype(np.float64 if most == 1 else np.uint8)
    filtered[:, :3] = done.values / (255 / most)
    return filtered, cast(ColorsReport, done.plain_report)


def _filtered_together(fields: NDArray[np.float64]) -> Iterator[list[int]]:
    """Yield blocks of columns that lack data at the same vertices: one surface, one run."""
    blocks: dict[bytes, list[int]] = {}
    for j, field in enumerate(fields.T):
        blocks.setdefault(np.packbits(np.isnan(field)).tobytes(), []).append(j)
    for columns in blocks.values():
        for first in range(0, len(columns), _TOGETHER):
            yield columns[first : first + _TOGETHER]


def _warning_of_labels(values: NDArray[Any]) -> list[Warned]:
    """Warn of integers that may be labels: few different ones, and each often."""
    if not (np.issubdtype(values.dtype, np.integer) or values.dtype == bool):
        return []
    count = len(np.unique(values))
    if not 1 < count <= min(_MOST_LABELS, values.size // 4):
        return []
    text = (
        f"values: {count} different integers are averaged to fractions; if they are labels, filter "
        "where each of them is, and take the label with most weight: see help(filter_scalars)"
    )
    return [Warned("labels", text)]


def _smoothing(
    fwhm: float, options: FilterOptions | None, named: Any, gain: Gain | None
) -> tuple[None, Any]:
    """Return the options of a call with `fwhm`; raise OptionError with others that contradict."""
    if gain is not None or options is not None or "feature_size" in named:
        raise OptionError("fwhm: replaces feature_size, options and gain; give one of them")
    if named.get("filter_type", "low-pass") != "low-pass":
        raise OptionError(f"fwhm: for a low-pass, not for filter_type = {named['filter_type']}")
    if named.get("response", "gaussian") != "gaussian":
        raise OptionError(f"fwhm: for a Gaussian, not for response = {named['response']}")
    if not (isinstance(fwhm, Real) and fwhm > 0 and isfinite(fwhm)):
        raise OptionError(f"fwhm = {fwhm}: must be a length above zero, in the units of the mesh")
    return None, {**named, "feature_size": _SIZE_PER_FWHM * fwhm}


def _parameters(options: FilterOptions | None, named: Any, gain: Gain | None) -> dict[str, Any]:
    """Return the options of a call; raise OptionError for those that apply only to shapes."""
    for name in named:
        if name not in TransferKeywords.__annotations__:
            FilterOptions.from_dict(named)  # an unknown name has an error of its own
            raise OptionError(
                f"{name}: not for values on a fixed shape; choose "
                f"{', '.join(TransferKeywords.__annotations__)}"
            )
    chosen = FilterOptions.from_call(options, named)
    if gain is not None:
        require_no_type(chosen.filter_type)
    parameters = chosen.core_parameters()
    return {name: parameters[name] for name in TransferKeywords.__annotations__}
