"""The fractional filter, on NumPy arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.filters.calling import filtered_arrays
from meshlab_spectral.filters.options import FilterOptions

# The vertex attribute in which the filter stores the details.
DETAILS = "spectral_details"


def filter_mesh(
    vertices: ArrayLike, faces: ArrayLike, options: FilterOptions | None = None, **named: Any
) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """Filter a mesh by the size of its details.

    Parameters
    ----------
    vertices
        n x 3 coordinates, finite.
    faces
        m x 3 indices of the corners of triangles, from 0 to n - 1; any topology.
    options
        All options in one object, or
    **named
        fields of `FilterOptions` by name; sizes as a string such as "2%" of the bounding box
        diagonal or "6e" (mean edges), or as a length in the units of the mesh.

    Returns
    -------
    V : array
        n x 3 filtered coordinates; the faces do not change. With result="details", what the
        filter takes away instead: the coordinates minus the filtered ones.
    report : dict
        Numbers, and lists for vectors; lengths in the units of the mesh. "warnings" lists what fell
        short of the options and what to do about it.

    Raises
    ------
    ValueError
        When an array has the wrong shape or type, or an index is out of range.
    OptionError
        When an option is unknown or has an invalid value.
    FilterError
        When the filter rejects the mesh: no faces, no area, or non-finite coordinates.
    PluginError
        When the plugin cannot be loaded.

    Examples
    --------
    >>> V, report = filter_mesh(vertices, faces, feature_size="2%")
    >>> report["max_displacement"]
    """
    parameters = FilterOptions.given(options, named)
    mesh_set, report = filtered_arrays(vertices, faces, parameters)
    mesh = mesh_set.current_mesh()
    if parameters.result == "details":
        return mesh.vertex_custom_point_attribute_matrix(DETAILS).copy(), report
    return mesh.vertex_matrix().copy(), report
