"""Filters of shapes, on arrays and on the meshes of other libraries."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import mesh_arrays, selected_vertices, vertex_numbers
from meshlab_spectral.filters.mesh_objects import PYMESHLAB, array_of, kind_of
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.progress import Progress
from meshlab_spectral.filters.running import Gain, run
from meshlab_spectral.plugin.mesh_sets import written_copy


def filter_shape(
    mesh_or_vertices: Any,
    faces: ArrayLike | None,
    options: Options,
    *,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
    gain: Gain | None = None,
    progress: Progress | bool | None = None,
    threads: int | None = None,
) -> tuple[Any, dict[str, Any]]:
    """Apply the filter that `options` belong to.

    The mesh is as for `mesh_arrays`; errors are those of `mesh_arrays` and `run`. `weights` and
    `selection` are what the options `weight` and `selected` refer to; a pymeshlab mesh has its own,
    too. Returns n x 3 coordinates, or a mesh of the type passed, with its data, or n x 3
    differences if details are wanted; and the report, with lists instead of arrays.
    """
    V, F = mesh_arrays(mesh_or_vertices, faces)
    kind = kind_of(mesh_or_vertices)
    own = kind.data(mesh_or_vertices) if kind is PYMESHLAB else {}
    if weights is None and getattr(options, "weight", "none") != "none":
        weights = own.get("quality")
    if selection is None and getattr(options, "selected", False):
        selection = own.get("selection")
    parameters, values = options.core_parameters(), None
    if weights is not None:
        array = array_of(mesh_or_vertices, weights, "weights")
        values = vertex_numbers(array, len(V), "weights")[:, None]
        parameters["weight"] = "vertex quality"
    elif getattr(options, "weight", "none") != "none":
        raise OptionError("weight = vertex quality: pass the quality as weights")
    selected = selected_vertices(mesh_or_vertices, selection, len(V), F, parameters)
    done = run(
        options.FILTER,
        V,
        F,
        parameters,
        selected=selected,
        values=values,
        gain=gain,
        progress=progress,
        threads=threads,
    )
    report = done.plain_report
    if done.details is not None:
        return done.details, report
    if done.values is not None:
        report["noise_heights"] = done.values[:, 0].tolist()
    if kind is PYMESHLAB:  # which keeps the heights, too
        copy = written_copy(mesh_or_vertices, done.vertices, done.values, options.FILTER)
        return copy, report
    X = V.copy() if done.vertices is None else done.vertices
    return X if kind is None else kind.moved(mesh_or_vertices, X), report
