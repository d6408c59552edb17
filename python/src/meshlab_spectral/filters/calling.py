"""Calling the plugin's filters: with their warnings, and with errors of this package."""

from __future__ import annotations

from typing import Any

from meshlab_spectral.errors import FilterError
from meshlab_spectral.plugin.last_warnings import last_warnings

# After a filter has thrown, destroying its MeshSet makes pymeshlab 2025.7 crash at the next one
# (MeshLab's own filters do the same). Such a MeshSet is therefore kept until the process ends.
_failed_mesh_sets: list[Any] = []


def call_filter(mesh_set: Any, name: str, parameters: dict[str, Any]) -> dict[str, Any]:
    """Apply a filter of the plugin to the current mesh of a MeshSet.

    Parameters
    ----------
    mesh_set
        A `pymeshlab.MeshSet`.
    name
        The filter's Python name; its plugin has been loaded.
    parameters
        As pymeshlab takes them.

    Returns
    -------
    dict
        The filter's report, as pymeshlab gives it, and "warnings": the list of what fell short
        without being an error, in the plugin's words.

    Raises
    ------
    FilterError
        When the filter refuses the mesh or the parameters: with what is wrong and what to do.
    PluginError
        When the plugin cannot tell its warnings, see `last_warnings`.
    """
    import pymeshlab

    last_warnings()  # raises before the work, not after it
    try:
        report: dict[str, Any] = mesh_set.apply_filter(name, **parameters)
    except pymeshlab.PyMeshLabException as error:
        keep_failed(mesh_set)
        raise FilterError(reason_of(error)) from error
    report["warnings"] = last_warnings()
    return report


def keep_failed(mesh_set: Any) -> None:
    """Keep a MeshSet in which a filter has failed from being destroyed."""
    _failed_mesh_sets.append(mesh_set)


def plain_report(report: dict[str, Any]) -> dict[str, Any]:
    """Turn the arrays of a filter's report into lists, for JSON."""
    return {
        name: value.tolist() if hasattr(value, "tolist") else value
        for name, value in report.items()
    }


def reason_of(error: Exception) -> str:
    """Take what matters of pymeshlab's message, on one line."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    for start in ("Details: ", "Error details: "):
        for number, line in enumerate(lines):
            if line.startswith(start):
                return " ".join([line.removeprefix(start), *lines[number + 1 :]])
    return " ".join(lines)
