"""Filters for scalars and colours at the vertices of a mesh, on arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import mesh_arrays
from meshlab_spectral.filters.calling import call_filter, mesh_set_of, plain_report
from meshlab_spectral.filters.gain_points import with_gain
from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.options import FilterOptions, TransferKeywords

if TYPE_CHECKING:
    from typing_extensions import Unpack

_SCALARS = "apply_scalar_spectral_filter_per_vertex"
_COLORS = "apply_color_spectral_filter_per_vertex"


@takes_options(FilterOptions, names=TransferKeywords.__annotations__)
def filter_scalars(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    values: ArrayLike | None = None,
    options: FilterOptions | None = None,
    *,
    gain: Callable[[float], float] | None = None,
    **named: Unpack[TransferKeywords],
) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """Filter a scalar field on a mesh by the size of its details; the shape stays as it is.

    With A the Laplacian of the mesh and F the transfer function that `filter_mesh` would apply to
    the coordinates, the result is ``F(sqrt(A)) values`` over the whole spectrum. The area-weighted
    mean of every connected component is kept; values are not clamped.

    A size is a string such as "2%" (of the bounding box diagonal) or "6e" (mean edges), or a length
    in the units of the mesh. With boundary="fixed", values on the boundary do not change.

    Parameters
    ----------
    mesh_or_vertices
        Finite n x 3 coordinates, or a pyvista, trimesh, meshio, Open3D or pymeshlab triangle mesh.
    faces
        With coordinates: m x 3 vertex indices of triangles, from 0 to n - 1; any topology.
    values
        n numbers, or n x k for k fields, each filtered on its own. NaN means no data: it stays, and
        the surface ends there for the others. Values at unreferenced vertices are kept exactly.
    options
        All options below in one object, instead of by name; others must have their defaults.
    gain
        As for `filter_mesh`.
    **named

    Returns
    -------
    values : array
        The filtered values, in the shape of the input.
    report : dict
        Numbers: `rms_change` over the surface and `max_change`, in the units of the values;
        `error_estimate`, relative to their largest deviation from the means; and others.
        "warnings" lists problems and what to do about them. For n x k values, a list of the k
        reports as "columns".

    Raises
    ------
    ValueError
        When an array has the wrong shape or type, or an index is out of range.
    OptionError
        When an option is unknown, has an invalid value, or applies only to shapes.
    FilterError
        When the mesh has no faces, no area or non-finite coordinates, a value is infinite, or all
        are NaN.
    PluginError
        When the plugin cannot be loaded.

    Examples
    --------
    >>> smooth, report = filter_scalars(vertices, faces, curvature, feature_size="2%")
    >>> report["rms_change"], report["max_change"]
    """
    V, F = mesh_arrays(mesh_or_vertices, faces)
    if values is None:
        raise TypeError("values: pass numbers to filter, one for each vertex")
    parameters = _options_for(V, F, options, named, gain)
    Q = np.asarray(values, dtype=np.float64)
    if Q.ndim not in (1, 2) or len(Q) != len(V) or Q.size == 0:
        raise ValueError(
            f"values have shape {Q.shape}: pass {len(V)} numbers, one for each vertex, or a matrix "
            f"with {len(V)} rows"
        )
    if Q.ndim == 2:
        columns = [filter_scalars(V, F, column, parameters) for column in Q.T]
        reports = [report for _, report in columns]
        warnings = [f"column {j}: {w}" for j, r in enumerate(reports) for w in r["warnings"]]
        filtered = np.column_stack([values for values, _ in columns])
        return filtered, {"columns": reports, "warnings": warnings}
    mesh_set, report = _filtered(_SCALARS, V, F, parameters, {"v_scalar_array": Q})
    return mesh_set.current_mesh().vertex_scalar_array().copy(), report


@takes_options(FilterOptions, names=TransferKeywords.__annotations__)
def filter_colors(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    colors: ArrayLike | None = None,
    options: FilterOptions | None = None,
    *,
    gain: Callable[[float], float] | None = None,
    **named: Unpack[TransferKeywords],
) -> tuple[NDArray[Any], dict[str, Any]]:
    """Filter colours at the vertices: red, green and blue as by `filter_scalars`.

    Parameters
    ----------
    mesh_or_vertices, faces, options, gain
        As for `filter_scalars`.
    colors
        n x 3 or n x 4 integers from 0 to 255, or floating-point numbers from 0 to 1; the fourth
        channel, alpha, is kept.
    **named

    Returns
    -------
    colors : array
        The filtered levels, in the shape and range of the input: integers as uint8, clamped and
        rounded; floating-point numbers in steps of 1/255, as MeshLab stores them.
    report : dict
        As from `filter_scalars`, with changes in levels, and `clamped_values`.
    """
    V, F = mesh_arrays(mesh_or_vertices, faces)
    if colors is None:
        raise TypeError("colors: pass red, green and blue of each vertex")
    parameters = _options_for(V, F, options, named, gain)
    C = np.asarray(colors)
    most = 1 if np.issubdtype(C.dtype, np.floating) else 255
    if C.shape not in ((len(V), 3), (len(V), 4)) or not ((C >= 0) & (most >= C)).all():
        raise ValueError(
            f"colors: pass {len(V)} x 3 or {len(V)} x 4 integers from 0 to 255, or floating-point "
            "numbers from 0 to 1"
        )
    levels = np.column_stack([C / most, np.ones((len(V), 4 - C.shape[1]))])
    mesh_set, report = _filtered(_COLORS, V, F, parameters, {"v_color_matrix": levels})
    filtered = mesh_set.current_mesh().vertex_color_matrix()[:, : C.shape[1]].copy()
    return filtered if most == 1 else np.round(255 * filtered).astype(np.uint8), report


def _options_for(
    V: Any, F: Any, options: FilterOptions | None, named: Any, gain: Callable[[float], float] | None
) -> FilterOptions:
    """Return the options of a call; raise OptionError for those that apply only to shapes."""
    for name in named:
        if name not in TransferKeywords.__annotations__:
            FilterOptions.from_dict(named)  # an unknown name has an error of its own
            raise OptionError(
                f"{name}: not for values on a fixed shape; choose "
                f"{', '.join(TransferKeywords.__annotations__)}"
            )
    parameters = FilterOptions.given(options, named)
    return parameters if gain is None else with_gain(parameters, gain, V, F)


def _filtered(
    name: str, V: Any, F: Any, options: FilterOptions, signal: dict[str, NDArray[Any]]
) -> tuple[Any, dict[str, Any]]:
    """Apply a filter to a signal on a mesh; return a MeshSet with the result, and the report."""
    mesh_set = mesh_set_of(V, F, signal)
    known = mesh_set.filter_parameter_values(name)
    all_given = options.pymeshlab_parameters(mesh_set.current_mesh())
    given = {option: value for option, value in all_given.items() if option in known}
    return mesh_set, plain_report(call_filter(mesh_set, name, given))
