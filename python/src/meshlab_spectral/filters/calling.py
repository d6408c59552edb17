"""Calls of the plugin's filters: adds their warnings, translates their errors."""

from __future__ import annotations

import re
from typing import Any

from numpy.typing import ArrayLike

from meshlab_spectral.errors import FilterError
from meshlab_spectral.filters.arrays import mesh_arrays
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.plugin.failed_calls import keep_failed
from meshlab_spectral.plugin.library import last_summary, last_warnings
from meshlab_spectral.plugin.loading import load

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
        pymeshlab's report, and in the plugin's words "warnings", a list of what fell short without
        being an error, and of a filter that chooses by itself "summary", what it found and did.

    Raises
    ------
    FilterError
        When the filter rejects the mesh or the parameters; says what is wrong and what to do.
    PluginError
        When the plugin's warnings are not available, see `last_warnings`.
    """
    import pymeshlab

    last_warnings()  # if this fails, fail before the computation
    try:
        report: dict[str, Any] = mesh_set.apply_filter(name, **parameters)
    except pymeshlab.PyMeshLabException as error:
        keep_failed(mesh_set)
        raise FilterError(_size_wanted(reason_of(error))) from error
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


def filtered_arrays(
    vertices: ArrayLike, faces: ArrayLike, options: Options
) -> tuple[Any, dict[str, Any]]:
    """Apply the filter of a table of options to a mesh from arrays.

    Returns
    -------
    mesh_set : pymeshlab.MeshSet
        With the result.
    report : dict
        As from `call_filter`, with lists instead of arrays.

    Raises
    ------
    ValueError, FilterError, PluginError
        As `mesh_arrays`, `call_filter` and `load`.
    """
    V, F = mesh_arrays(vertices, faces)
    load()
    import pymeshlab

    mesh_set = pymeshlab.MeshSet()
    mesh_set.add_mesh(pymeshlab.Mesh(V, F))
    parameters = options.pymeshlab_parameters(mesh_set.current_mesh())
    report = call_filter(mesh_set, options.FILTER, parameters)
    return mesh_set, plain_report(report)


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
    """Name the parameters that have not the types of their defaults, as pymeshlab does not."""
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


def plain_report(report: dict[str, Any]) -> dict[str, Any]:
    """Convert the arrays in a filter's report to lists, for JSON."""
    return {
        name: value.tolist() if hasattr(value, "tolist") else value
        for name, value in report.items()
    }


def reason_of(error: Exception) -> str:
    """Extract the relevant part of pymeshlab's message, as one line."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    for start in ("Details: ", "Error details: "):
        for number, line in enumerate(lines):
            if line.startswith(start):
                return " ".join([line.removeprefix(start), *lines[number + 1 :]])
    return " ".join(lines)
