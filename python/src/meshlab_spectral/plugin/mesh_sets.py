"""pymeshlab's MeshSets: results written to their meshes, and filters of the plugin in scripts."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral import errors
from meshlab_spectral.errors import FilterError
from meshlab_spectral.plugin.failed_calls import corrected, is_interrupt, keep_failed
from meshlab_spectral.plugin.library import function_of, last_error, last_summary, last_warnings
from meshlab_spectral.plugin.loading import FILTER_NAME, load, loaded_plugin
from meshlab_spectral.warned import with_warnings

Array = NDArray[np.float64]

# The vertex attributes in which the plugin stores the details, and the height of noise.
DETAILS = "spectral_details"
NOISE_HEIGHT = "noise_height"

_GIVEN = (ctypes.c_int, *[ctypes.c_void_p] * 3, ctypes.c_char_p)


def mesh_set_of(
    V: Array,
    F: NDArray[np.integer],
    data: Mapping[str, NDArray[Any]] | None = None,
    verbose: bool = False,
) -> Any:
    """Return a `pymeshlab.MeshSet` with one mesh.

    `V` and `F` are as from `mesh_arrays`; `data` are further arguments of `pymeshlab.Mesh`, such as
    `v_scalar_array`. With `verbose`, MeshLab writes its log. Raises PluginError when the plugin
    cannot be loaded.
    """
    load()  # first: its error says what to do if pymeshlab is missing
    import pymeshlab

    return _set_with(pymeshlab.Mesh(V, F, **(data or {})), verbose)


def written_copy(
    mesh: Any,
    vertices: Array | None = None,
    values: Array | None = None,
    name: str = FILTER_NAME,
) -> Any:
    """Return a copy of a `pymeshlab.Mesh` with what the filter `name` has returned, see `write`."""
    load()
    mesh_set = _set_with(mesh)
    write(mesh_set, name, vertices=vertices, values=values)
    copy = mesh_set.current_mesh()
    weakref.finalize(copy, id, mesh_set)  # keeps the MeshSet alive, which owns the mesh
    return copy


def write(
    mesh_set: Any,
    name: str,
    *,
    vertices: Array | None = None,
    details: Array | None = None,
    values: Array | None = None,
    text: str = "",
) -> None:
    """Write what the filter `name` has returned to the current mesh of a MeshSet.

    That is what the filter itself would write: n x 3 `vertices` with their normals, n x 3 `details`
    and n heights of noise, `values`, as attributes; `text` goes to the log. Raises FilterError when
    MeshLab's numbers cannot hold it.
    """
    give = function_of(loaded_plugin(), "meshlab_spectral_give", _GIVEN)
    arrays = [
        None if one is None else np.ascontiguousarray(one, dtype=np.float64)
        for one in (vertices, details, values)
    ]
    addresses = [None if one is None else one.ctypes.data for one in arrays]
    give(mesh_set.current_mesh().vertex_number(), *addresses, text.encode())
    try:
        call_filter(mesh_set, name, {})
    finally:
        give(0, None, None, None, b"")  # it has been taken, unless pymeshlab has refused the call


def call_filter(mesh_set: Any, name: str, parameters: dict[str, Any]) -> dict[str, Any]:
    """Apply a filter of the plugin to the current mesh of a MeshSet, as a script does.

    The plugin must be loaded; `name` is the filter's in Python, `parameters` are keyword arguments
    for pymeshlab. Returns pymeshlab's report, with the warnings and the summary that it drops.
    Raises FilterError when the filter rejects the mesh or the parameters, KeyboardInterrupt on
    Ctrl-C, the mesh unchanged, and PluginError as from `last_warnings`.
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
    report = with_warnings(report, last_warnings())
    if summary := last_summary():
        report["summary"] = summary
    return report


def _set_with(mesh: Any, verbose: bool = False) -> Any:
    """Return a MeshSet with a copy of a mesh; the plugin must be loaded."""
    import pymeshlab

    mesh_set = pymeshlab.MeshSet(verbose=verbose)
    mesh_set.add_mesh(mesh)
    return mesh_set


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
