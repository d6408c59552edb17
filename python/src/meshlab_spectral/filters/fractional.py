"""The fractional filter, on arrays and meshes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from meshlab_spectral.filters.arrays import mesh_arrays
from meshlab_spectral.filters.calling import filtered, given_back
from meshlab_spectral.filters.gain_points import with_gain
from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.options import FilterKeywords, FilterOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack

# The vertex attribute in which the filter stores the details.
DETAILS = "spectral_details"


@takes_options(FilterOptions)
def filter_mesh(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    options: FilterOptions | None = None,
    *,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
    gain: Callable[[float], float] | None = None,
    **named: Unpack[FilterKeywords],
) -> tuple[Any, dict[str, Any]]:
    """Filter a mesh by the size of its details.

    A size is a string such as "2%" (of the bounding box diagonal) or "6e" (mean edges), or a length
    in the units of the mesh.

    Parameters
    ----------
    mesh_or_vertices
        Finite n x 3 coordinates, or a pyvista, trimesh, meshio, Open3D or pymeshlab triangle mesh.
    faces
        With coordinates: m x 3 vertex indices of triangles, from 0 to n - 1; any topology.
    options
        All options below in one object, instead of by name.
    weights
        n numbers: how much of the filter each vertex gets, from 0 (nothing) to 1 (all).
    selection
        What to filter: n booleans, one per vertex, or indices of faces; around it, the effect fades
        out within about a feature size.
    gain
        Gain, finite and >= 0, as a function of w > 0, the feature size over the wavelength; in
        place of filter_type="custom". Called a few thousand times, with one number each.
    **named

    Returns
    -------
    filtered
        n x 3 coordinates, or a mesh of the type passed, with its data; the faces do not change.
        With result="details", n x 3 differences instead, which the filter takes away: the
        coordinates minus the filtered ones.
    report : dict
        Numbers, and lists for vectors; lengths in the units of the mesh. "warnings" lists what fell
        short of the options, or had no effect, and what to do about it.

    Raises
    ------
    ValueError
        When an array has the wrong shape or type, or an index is out of range.
    TypeError
        When the mesh is of none of these libraries.
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
    >>> smooth, report = filter_mesh(pyvista.read("scan.ply"), gain=lambda w: 1 / (1 + w**4))
    """
    parameters = FilterOptions.given(options, named)
    if gain is not None:
        parameters = with_gain(parameters, gain, *mesh_arrays(mesh_or_vertices, faces))
    mesh_set, report = filtered(mesh_or_vertices, faces, parameters, weights, selection)
    if parameters.result == "details":
        mesh = mesh_set.current_mesh()
        return mesh.vertex_custom_point_attribute_matrix(DETAILS).copy(), report
    return given_back(mesh_or_vertices, mesh_set), report
