"""Calls of the plugin's filters: adds their warnings, translates their errors."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import FilterError, OptionError
from meshlab_spectral.filters.arrays import chosen_vertices, mesh_arrays, vertex_numbers
from meshlab_spectral.filters.mesh_objects import PYMESHLAB, kind_of, owned_mesh
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.plugin.failed_calls import is_interrupt, keep_failed
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

    last_warnings()  # if this fails, fail before the computation
    try:
        report: dict[str, Any] = mesh_set.apply_filter(name, **parameters)
    except pymeshlab.PyMeshLabException as error:
        keep_failed(mesh_set)
        if is_interrupt(error):
            raise KeyboardInterrupt from None
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


def filtered(
    mesh_or_vertices: Any,
    faces: ArrayLike | None,
    options: Options,
    weights: ArrayLike | None = None,
    selection: ArrayLike | None = None,
) -> tuple[Any, dict[str, Any]]:
    """Apply the filter that `options` belong to.

    The mesh is as for `mesh_arrays`; errors are those of `mesh_arrays`, `call_filter` and `load`.
    `weights` and `selection` are what the options `weight` and `selected` refer to; a pymeshlab
    mesh has its own.

    Returns
    -------
    mesh_set : pymeshlab.MeshSet
        With the result; a pymeshlab mesh keeps its data.
    report : dict
        As from `call_filter`, with lists instead of arrays.
    """
    V, F = mesh_arrays(mesh_or_vertices, faces)
    if kind_of(mesh_or_vertices) is PYMESHLAB:
        if weights is not None or selection is not None:
            raise OptionError(
                "weights, selection: a pymeshlab mesh has its own; give weight='vertex quality' or "
                "selected=True, or pass vertices and faces"
            )
        load()
        mesh_set = _set_of(mesh_or_vertices)
    else:
        data: dict[str, NDArray[Any]] = {}
        part: dict[str, Any] = {}
        if weights is not None:
            data["v_scalar_array"] = vertex_numbers(weights, len(V), "weights")
            part["weight"] = "vertex quality"
        elif getattr(options, "weight", "none") != "none":
            raise OptionError("weight = vertex quality: pass the quality as weights")
        mesh_set = mesh_set_of(V, F, data)
        if selection is not None:
            select_vertices(mesh_set, chosen_vertices(selection, len(V), F))
            part["selected"] = True
        elif getattr(options, "selected", False):
            raise OptionError("selected = True: pass the selected vertices or faces as selection")
        options = replace(options, **part)
    parameters = options.pymeshlab_parameters(mesh_set.current_mesh())
    report = call_filter(mesh_set, options.FILTER, parameters)
    return mesh_set, plain_report(report)


def given_back(mesh_or_vertices: Any, mesh_set: Any) -> Any:
    """Return the current mesh of a MeshSet in the form that was passed: coordinates or a mesh."""
    kind = kind_of(mesh_or_vertices)
    if kind is PYMESHLAB:
        return owned_mesh(mesh_set)
    V = mesh_set.current_mesh().vertex_matrix().copy()
    return V if kind is None else kind.moved(mesh_or_vertices, V)


def select_vertices(mesh_set: Any, chosen: NDArray[np.bool_]) -> None:
    """Select vertices, which pymeshlab can only do by a condition."""
    mesh_set.current_mesh().add_vertex_custom_scalar_attribute(chosen.astype(float), "chosen")
    mesh_set.compute_selection_by_condition_per_vertex(condselect="chosen > 0.5")


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
