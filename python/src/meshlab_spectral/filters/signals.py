"""Filters of numbers and colours at the vertices of a mesh, on NumPy arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import mesh_arrays
from meshlab_spectral.filters.calling import call_filter, plain_report
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.plugin.loading import load

_SCALARS = "apply_scalar_spectral_filter_per_vertex"
_COLORS = "apply_color_spectral_filter_per_vertex"


def filter_scalars(
    vertices: ArrayLike, faces: ArrayLike, values: ArrayLike, **options: Any
) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """Filter a scalar field on a mesh by the size of its details; the shape stays as it is.

    With A the Laplacian of the mesh and F the transfer function that `filter_mesh` would apply to
    the coordinates, the result is ``F(sqrt(A)) values`` over the whole spectrum. The area-weighted
    mean of every connected component is kept; values are not clamped.

    Parameters
    ----------
    vertices
        n x 3 coordinates, finite.
    faces
        m x 3 indices of the corners of triangles, from 0 to n - 1; any topology.
    values
        n numbers, or n x k for k fields, each filtered by itself. NaN is no data: it stays, and the
        surface ends there for the rest. Values at vertices without faces are kept to the bit.
    **options
        Fields of `FilterOptions` that describe the transfer function, `laplacian` and `boundary`:
        "fixed" keeps the values on the boundary. Sizes as a string such as "2%" of the bounding box
        diagonal or "6e" (mean edges), or as a length in the units of the mesh.

    Returns
    -------
    values : array
        The filtered values, of the shape that was given.
    report : dict
        Numbers: `rms_change` over the surface and `max_change`, in the units of the values;
        `error_estimate`, relative to their largest deviation from the means; and others.
        "warnings" lists what fell short and what to do about it. Of n x k values, a list of the k
        reports as "columns".

    Raises
    ------
    ValueError
        When an array has the wrong shape or type, or an index is out of range.
    OptionError
        When an option is unknown, has an invalid value, or is not for values on a fixed shape.
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
    V, F = mesh_arrays(vertices, faces)
    Q = np.asarray(values, dtype=np.float64)
    if Q.ndim not in (1, 2) or len(Q) != len(V) or Q.size == 0:
        raise ValueError(
            f"values have shape {Q.shape}: pass {len(V)} numbers, one for each vertex, or a matrix "
            f"with {len(V)} rows"
        )
    if Q.ndim == 2:
        columns = [filter_scalars(V, F, column, **options) for column in Q.T]
        reports = [report for _, report in columns]
        warnings = [f"column {j}: {w}" for j, r in enumerate(reports) for w in r["warnings"]]
        filtered = np.column_stack([values for values, _ in columns])
        return filtered, {"columns": reports, "warnings": warnings}
    mesh_set, report = _filtered(_SCALARS, V, F, options, v_scalar_array=Q)
    return mesh_set.current_mesh().vertex_scalar_array().copy(), report


def filter_colors(
    vertices: ArrayLike, faces: ArrayLike, colors: ArrayLike, **options: Any
) -> tuple[NDArray[Any], dict[str, Any]]:
    """Filter colours at the vertices, as `filter_scalars` does red, green and blue.

    Parameters
    ----------
    vertices, faces, **options
        As for `filter_scalars`.
    colors
        n x 3 or n x 4 integers from 0 to 255, or floating-point numbers from 0 to 1; the fourth,
        alpha, is kept.

    Returns
    -------
    colors : array
        The filtered levels, of the shape and in the range that was given: integers as uint8,
        clamped and rounded; floating-point numbers in steps of 1/255, as MeshLab has them.
    report : dict
        As from `filter_scalars`, changes in levels; and `clamped_values`.
    """
    V, F = mesh_arrays(vertices, faces)
    C = np.asarray(colors)
    most = 1 if np.issubdtype(C.dtype, np.floating) else 255
    if C.shape not in ((len(V), 3), (len(V), 4)) or not ((C >= 0) & (most >= C)).all():
        raise ValueError(
            f"colors: pass {len(V)} x 3 or {len(V)} x 4 integers from 0 to 255, or floating-point "
            "numbers from 0 to 1"
        )
    levels = np.column_stack([C / most, np.ones((len(V), 4 - C.shape[1]))])
    mesh_set, report = _filtered(_COLORS, V, F, options, v_color_matrix=levels)
    filtered = mesh_set.current_mesh().vertex_color_matrix()[:, : C.shape[1]].copy()
    return filtered if most == 1 else np.round(255 * filtered).astype(np.uint8), report


def _filtered(
    name: str, V: Any, F: Any, options: dict[str, Any], **signal: NDArray[Any]
) -> tuple[Any, dict[str, Any]]:
    """Apply a filter of signals to a mesh with one: a MeshSet with the result, and the report."""
    parameters = FilterOptions.from_dict(options)
    load()
    import pymeshlab

    mesh_set = pymeshlab.MeshSet()
    mesh_set.add_mesh(pymeshlab.Mesh(V, F, **signal))
    known = mesh_set.filter_parameter_values(name)
    for option in options:
        if option not in known:
            raise OptionError(
                f"{option}: not for values on a fixed shape; choose {', '.join(known)}"
            )
    all_given = parameters.pymeshlab_parameters(mesh_set.current_mesh())
    given = {option: value for option, value in all_given.items() if option in known}
    return mesh_set, plain_report(call_filter(mesh_set, name, given))
