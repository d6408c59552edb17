"""Workarounds for what pymeshlab does wrong after a filter has thrown.

pymeshlab 2025.7 keeps writing to the log of the MeshSet in which a filter last threw
(cnr-isti-vclab/PyMeshLab#384), even after that MeshSet is destroyed: the next load would crash. It
is therefore kept alive until another one takes its place. pymeshlab also replaces the
KeyboardInterrupt that has stopped a filter of this plugin with an exception of its own.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from meshlab_spectral.plugin.pymeshlab_texts import corrected

_STOPPED = "Details: cancelled"
_last_failed: Any = None


def keep_failed(mesh_set: Any) -> None:
    """Keep alive the MeshSet in which a filter has failed, instead of the previous one."""
    global _last_failed
    _last_failed = mesh_set


def is_interrupt(error: Exception) -> bool:
    """Whether a signal stopped the filter; nothing else cancels a filter called from Python."""
    return str(error).rstrip().endswith(_STOPPED)


def kept_when_failed(name: str, method: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a filter, a method of MeshSet, so that its MeshSet is kept alive when it throws.

    What pymeshlab says of wrong arguments is put right, in an exception of the same type.
    """

    @functools.wraps(method)
    def keeping(mesh_set: Any, *arguments: Any, **parameters: Any) -> Any:
        try:
            return method(mesh_set, *arguments, **parameters)
        except Exception as error:
            keep_failed(mesh_set)
            if is_interrupt(error):
                raise KeyboardInterrupt from None
            text = corrected(mesh_set, name, parameters, error)
            if text != str(error):
                raise type(error)(text) from None
            raise

    return keeping
