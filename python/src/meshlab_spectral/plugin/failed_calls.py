"""What pymeshlab leaves undone after a filter has thrown.

pymeshlab 2025.7 goes on writing to the log of the MeshSet in which a filter has thrown last
(cnr-isti-vclab/PyMeshLab#384), also when that MeshSet does not exist any more: the next load would
crash. It is therefore kept alive until another one takes its place. And pymeshlab replaces the
KeyboardInterrupt that has stopped a filter of this plugin by an exception of its own.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

_STOPPED = "Details: cancelled"
_last_failed: Any = None


def keep_failed(mesh_set: Any) -> None:
    """Keep the MeshSet alive in which a filter has failed, in place of the one before."""
    global _last_failed
    _last_failed = mesh_set


def is_interrupt(error: Exception) -> bool:
    """Whether a filter has stopped for a signal, which is all that stops one called by Python."""
    return str(error).rstrip().endswith(_STOPPED)


def kept_when_failed(method: Callable[..., Any]) -> Callable[..., Any]:
    """Return a method of MeshSet, a filter, that keeps its MeshSet alive when it throws."""

    @functools.wraps(method)
    def keeping(mesh_set: Any, *arguments: Any, **parameters: Any) -> Any:
        try:
            return method(mesh_set, *arguments, **parameters)
        except Exception as error:
            keep_failed(mesh_set)
            if is_interrupt(error):
                raise KeyboardInterrupt from None
            raise

    return keeping
