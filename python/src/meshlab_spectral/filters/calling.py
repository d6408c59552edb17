"""Calls of the plugin's filters in MeshSets: adds their warnings, translates their errors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral import errors
from meshlab_spectral.errors import FilterError
from meshlab_spectral.filters.mesh_objects import owned_mesh
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.representations import Report
from meshlab_spectral.filters.running import plain
from meshlab_spectral.plugin.failed_calls import is_interrupt, keep_failed
from meshlab_spectral.plugin.library import last_error, last_summary, last_warnings
from meshlab_spectral.plugin.loading import load
from meshlab_spectral.plugin.pymeshlab_texts import corrected

# The vertex attributes in which the plugin stores the details, and the height of noise.
DETAILS = "spectral_details"
NOISE_HEIGHT = "noise_height"


def call_filter(mesh_set: Any, name: str, parameters: dict[str, Any]) -> dict[str, Any]:
    """Apply a filter of the plugin to the current mesh of a MeshSet.

    Parameters
    ----------
    mesh_set
        A `pymeshlab.MeshSet`.
    name
        The filter's Python name; the plugin must be loaded.
    parameters
        Keyword arguments for pymeshlab.

    Returns
    -------
    dict
        pymeshlab's report; in addition, in the plugin's words, "warnings", a list of problems that
        were not errors, and "summary", what a filter that chooses by itself found and did.

    Raises
    ------
    FilterError
        When the filter rejects the mesh or the parameters; says what is wrong and what to do.
    KeyboardInterrupt
        On Ctrl-C, within 0.3 s; the mesh is unchanged.
    PluginError
        When the plugin's warnings are not available, see `last_warnings`.
    """
    import pymeshlab

    last_error()  # so that no older one is taken for this; and if it fails, then at once
    try:
        report: dict[str, Any] = mesh_set.apply_filter(name, **parameters)
    except pymeshlab.PyMeshLabException as error:
        keep_failed(mesh_set)
        if is_interrupt(error):
            raise KeyboardInterrupt from None
        raise _error_of(reason_of(corrected(mesh_set, name, parameters, error))) from error
    except (pymeshlab.InvalidEnumException, RuntimeError, TypeError) as error:
        keep_failed(mesh_set)
        raise FilterError(reason_of(corrected(mesh_set, name, parameters, error))) from error
    report["warnings"] = last_warnings()
    if summary := last_summary():
        report["summary"] = summary
    return report


def mesh_set_of(
    V: NDArray[np.float64],
    F: NDArray[np.integer],
    data: Mapping[str, NDArray[Any]] | None = None,
    verbose: bool = False,
) -> Any:
    """Return a `pymeshlab.MeshSet` with one mesh, for filters of the plugin.

    `V` and `F` are as from `mesh_arrays`; `data` are further arguments of `pymeshlab.Mesh`, such as
    `v_scalar_array`. With `verbose`, MeshLab writes its log. Raises PluginError when the plugin
    cannot be loaded.
    """
    load()  # first: its error says what to do if pymeshlab is missing
    import pymeshlab

    return _set_of(pymeshlab.Mesh(V, F, **(data or {})), verbose)


def _set_of(mesh: Any, verbose: bool = False) -> Any:
    """Return a MeshSet with a copy of a mesh; the plugin must be loaded."""
    import pymeshlab

    mesh_set = pymeshlab.MeshSet(verbose=verbose)
    mesh_set.add_mesh(mesh)
    return mesh_set


def filtered_by_plugin(mesh: Any, options: Options) -> tuple[Any, dict[str, Any]]:
    """Apply the filter that `options` belong to, to a copy of a `pymeshlab.Mesh`.

    Returns the copy, or the details if these are wanted, and the report with lists for arrays.
    """
    load()
    mesh_set = _set_of(mesh)
    parameters = options.pymeshlab_parameters(mesh_set.current_mesh())
    report = Report(plain(call_filter(mesh_set, options.FILTER, parameters)))
    if getattr(options, "result", "") == "details":
        details = mesh_set.current_mesh().vertex_custom_point_attribute_matrix(DETAILS)
        return details.copy(), report
    return owned_mesh(mesh_set), report


def select_vertices(mesh_set: Any, chosen: NDArray[np.bool_]) -> None:
    """Select vertices, which pymeshlab can only do by a condition."""
    mesh_set.current_mesh().add_vertex_custom_scalar_attribute(chosen.astype(float), "chosen")
    mesh_set.compute_selection_by_condition_per_vertex(condselect="chosen > 0.5")


def _error_of(reason: str) -> FilterError:
    """Return the error that the plugin has thrown, or pymeshlab's."""
    found = last_error()
    if found is None:
        return FilterError(reason)
    kind, code, limit = found
    error: FilterError = getattr(errors, kind)(reason)
    error.code, error.limit = code, limit
    return error


def reason_of(error: Exception | str) -> str:
    """Extract the relevant part of pymeshlab's message, as one line."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    for start in ("Details: ", "Error details: "):
        for number, line in enumerate(lines):
            if line.startswith(start):
                return " ".join([line.removeprefix(start), *lines[number + 1 :]])
    return " ".join(lines)
