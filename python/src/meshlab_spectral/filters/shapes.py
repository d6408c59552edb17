"""Filters of shapes, on arrays and on the meshes of other libraries."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import chosen_vertices, mesh_arrays, vertex_numbers
from meshlab_spectral.filters.calling import filtered_by_plugin
from meshlab_spectral.filters.mesh_objects import PYMESHLAB, array_of, kind_of
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.progress import Progress
from meshlab_spectral.filters.running import Gain, run


def filtered(
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
    `selection` are what the options `weight` and `selected` refer to. A pymeshlab mesh has its own;
    it is filtered by the plugin, in a MeshSet, because pymeshlab has no other way to change it.

    Returns
    -------
    result
        n x 3 coordinates, or a mesh of the type passed, with its data; n x 3 differences if details
        are wanted.
    report : dict
        With lists instead of arrays.
    """
    V, F = mesh_arrays(mesh_or_vertices, faces)
    kind = kind_of(mesh_or_vertices)
    if kind is PYMESHLAB and gain is None:
        if weights is not None or selection is not None:
            raise OptionError(
                "weights, selection: a pymeshlab mesh has its own; give weight='vertex quality' or "
                "selected=True, or pass vertices and faces"
            )
        if progress:
            raise OptionError("progress: not for a pymeshlab mesh; pass its vertices and faces")
        return filtered_by_plugin(mesh_or_vertices, options)
    if kind is PYMESHLAB:
        raise OptionError("gain: not for a pymeshlab mesh; pass its vertices and faces")
    values = selected = None
    part: dict[str, Any] = {}
    if weights is not None:
        given = array_of(mesh_or_vertices, weights, "weights")
        values = vertex_numbers(given, len(V), "weights")[:, None]
        part["weight"] = "vertex quality"
    elif getattr(options, "weight", "none") != "none":
        raise OptionError("weight = vertex quality: pass the quality as weights")
    if selection is not None:
        selected = chosen_vertices(array_of(mesh_or_vertices, selection, "selection"), len(V), F)
        part["selected"] = True
    elif getattr(options, "selected", False):
        raise OptionError("selected = True: pass the selected vertices or faces as selection")
    done = run(
        options.FILTER,
        V,
        F,
        {**options.core_parameters(), **part},
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
    X = V.copy() if done.vertices is None else done.vertices
    return X if kind is None else kind.moved(mesh_or_vertices, X), report
