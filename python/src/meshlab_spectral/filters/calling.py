"""Calls of the plugin's filters in MeshSets: adds their warnings, translates their errors."""

from __future__ import annotations

import re
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

# The vertex attribute in which the plugin stores the details.
DETAILS = "spectral_details"

_PLAIN_SIZE = re.compile(r"Parameter (\w+): must be a pymeshlab\.Percentage")
_RANGE = re.compile(r"Must be a value between 0 and (\d+)")
_TOO_LARGE = 2**31


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
        raise _error_of(reason_of(error)) from error
    except pymeshlab.InvalidEnumException as error:
        keep_failed(mesh_set)
        raise FilterError(_no_such_choice(parameters, str(error))) from error
    except (RuntimeError, TypeError) as error:  # a type that pymeshlab cannot convert
        keep_failed(mesh_set)
        defaults = mesh_set.filter_parameter_values(name)
        raise FilterError(_wrong_types(parameters, defaults) or reason_of(error)) from error
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
        return FilterError(_size_wanted(reason))
    kind, code, limit = found
    error: FilterError = getattr(errors, kind)(reason)
    error.code, error.limit = code, limit
    return error


def _size_wanted(reason: str) -> str:
    """Replace pymeshlab's message for a size given as a plain number."""
    found = _PLAIN_SIZE.match(reason)
    if found is None:
        return reason
    return f"{found[1]}: must be a percentage or a length (RichPercentage in a script)"


def _no_such_choice(parameters: dict[str, Any], reason: str) -> str:
    """Add the parameter to pymeshlab's message, and correct its range."""
    named = [
        name
        for name, value in parameters.items()
        if reason.startswith((f"Enum {value} not valid", f"Enum '{value}' not found"))
    ]
    found = _RANGE.search(reason)
    choices = f"choose 0 to {int(found[1]) - 1}" if found else reason
    return f"{' or '.join(named)} = {parameters[named[0]]}: {choices}" if named else reason


def _wrong_types(parameters: dict[str, Any], defaults: dict[str, Any]) -> str:
    """Name the parameters whose types are not those of their defaults; pymeshlab does not."""
    kinds = {bool: "true or false", int: "an integer of 32 bits", float: "a number"}
    wrong = [
        f"{name} = {value}: must be {kinds.get(type(defaults[name]), 'of another type')}"
        for name, value in parameters.items()
        if name in defaults and not _fits(value, type(defaults[name]))
    ]
    return "; ".join(wrong)


def _fits(value: Any, wanted: type) -> bool:
    if wanted is int:
        return isinstance(value, int) and abs(value) < _TOO_LARGE
    if wanted is float:
        return value is not None and not isinstance(value, str)
    return isinstance(value, wanted)


def reason_of(error: Exception) -> str:
    """Extract the relevant part of pymeshlab's message, as one line."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    for start in ("Details: ", "Error details: "):
        for number, line in enumerate(lines):
            if line.startswith(start):
                return " ".join([line.removeprefix(start), *lines[number + 1 :]])
    return " ".join(lines)
