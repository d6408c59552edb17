"""The fractional filter, on arrays and meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, TypeVar, cast, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone
from meshlab_spectral.filters.options import FilterKeywords, FilterOptions, ShapeKeywords
from meshlab_spectral.filters.progress import Progress
from meshlab_spectral.filters.reports import FilterReport
from meshlab_spectral.filters.running import Gain, require_no_type
from meshlab_spectral.filters.shapes import filter_shape

if TYPE_CHECKING:
    from typing_extensions import Unpack

Mesh = TypeVar("Mesh")


class DetailsKeywords(ShapeKeywords):
    """Keywords with which `filter_mesh` returns differences."""

    result: Literal["details"]


@overload
def filter_mesh(
    mesh_or_vertices: ArrayLike,
    faces: ArrayLike,
    options: FilterOptions | None = None,
    *,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
    gain: Gain | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[FilterKeywords],
) -> tuple[NDArray[np.float64], FilterReport]: ...
@overload
def filter_mesh(
    mesh_or_vertices: Mesh,
    faces: None = None,
    options: FilterOptions | None = None,
    *,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
    gain: Gain | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[ShapeKeywords],
) -> tuple[Mesh, FilterReport]: ...
@overload
def filter_mesh(
    mesh_or_vertices: object,
    faces: None = None,
    options: FilterOptions | None = None,
    *,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
    gain: Gain | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[DetailsKeywords],
) -> tuple[NDArray[np.float64], FilterReport]: ...


@takes_options(FilterOptions)
@takes_mesh_alone
def filter_mesh(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    options: FilterOptions | None = None,
    *,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
    gain: Gain | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
    **named: Unpack[FilterKeywords],
) -> tuple[Any, FilterReport]:
    """Filter a mesh by the size of its details.

    A size is a string such as "2%" (of the bounding box diagonal) or "6e" (mean edges), or a length
    in the units of the mesh.

    Parameters
    ----------
    mesh_or_vertices
        Finite n x 3 coordinates, or a triangle mesh of pyvista, trimesh, meshio, Open3D, LaPy, pyFM
        or pymeshlab, or a tuple (vertices, faces).
    faces
        With coordinates: m x 3 vertex indices of triangles, from 0 to n - 1; any topology and
        orientation.
    options
        All options below in one object, instead of by name.
    weights
        n numbers: how much of the filter each vertex gets, from 0 (nothing) to 1 (all).
    selection
        What to filter: n booleans, one per vertex, or indices of faces; around it, the effect fades
        out within about a feature size.
    gain
        Gain, finite and >= 0, as a function of w > 0, the feature size over the wavelength; in
        place of filter_type="custom". Called once, with an array of a few thousand w.
    progress
        True shows a bar. A function is called about twenty times a second with the current stage
        and the fraction done, 0 to 1; it cancels by returning False.
    threads
        Number of threads of this call; by default that of `set_threads`.
    **named

    Returns
    -------
    filtered
        n x 3 coordinates, or a mesh of the type passed, with its data; the faces do not change.
        With result="details", n x 3 differences instead, which the filter takes away: the
        coordinates minus the filtered ones.
    report : FilterReport
        A dict. Numbers, and lists for vectors; lengths in the units of the mesh. "warnings" lists
        what fell short of the options, or had no effect, and what to do about it.

    Raises
    ------
    ArrayError
        When an array has the wrong shape or type, or an index is out of range.
    ArgumentError
        When the mesh is of none of these libraries.
    OptionError
        When an option is unknown or has an invalid value.
    FilterError
        When the filter rejects the mesh: no faces, no area, or non-finite coordinates. It is a
        MeshError, SolverError or MemoryLimitError, with the cause as `code`.
    Cancelled
        When `progress` has returned False.

    Examples
    --------
    >>> V, report = filter_mesh(vertices, faces, feature_size="2%")
    >>> report["max_displacement"]
    >>> smooth, report = filter_mesh(pyvista.read("scan.ply"), gain=lambda w: 1 / (1 + w**4))
    """
    parameters = FilterOptions.from_call(options, named)
    if gain is not None:
        require_no_type(parameters.filter_type)
    moved, report = filter_shape(
        mesh_or_vertices,
        faces,
        parameters,
        weights=weights,
        selection=selection,
        gain=gain,
        progress=progress,
        threads=threads,
    )
    return moved, cast(FilterReport, report)
