"""Calls of the plugin's filters: adds their warnings, translates their errors."""

from __future__ import annotations

from typing import Any

from meshlab_spectral.errors import FilterError
from meshlab_spectral.plugin.last_warnings import last_warnings

# pymeshlab 2025.7 crashes after a MeshSet in which any filter has thrown is destroyed. Such a
# MeshSet is therefore kept alive until the process ends.
_failed_mesh_sets: list[Any] = []


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
        pymeshlab's report, and "warnings": a list of what fell short without being an error, in the
        plugin's words.

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
        raise FilterError(reason_of(error)) from error
    report["warnings"] = last_warnings()
    return report


def keep_failed(mesh_set: Any) -> None:
    """Keep a MeshSet alive in which a filter has failed."""
    _failed_mesh_sets.append(mesh_set)


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
