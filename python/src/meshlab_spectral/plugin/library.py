"""Functions that the plugin's library offers besides its filters."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from meshlab_spectral.errors import PluginError
from meshlab_spectral.plugin.handle import opened
from meshlab_spectral.plugin.loading import loaded_plugin
from meshlab_spectral.warned import Warned


def last_warnings() -> list[Warned]:
    """Return the warnings of the plugin's latest filter run in this thread, unless it has failed.

    pymeshlab itself drops the strings of a filter's report. Raises PluginError when pymeshlab has
    loaded another copy of the plugin than `load` would, or one older than this package.
    """
    return [Warned(*line.split(" ", 1)) for line in _last("warnings").splitlines()]


def last_summary() -> str:
    """Return what the plugin's latest filter run in this thread found and did, in one line.

    Empty if the numbers of the report say it all. Errors are those of `last_warnings`.
    """
    return _last("summary")


def last_error() -> tuple[str, str, int] | None:
    """Return class, code and limit of the error of the latest run in this thread, if it had one.

    A second call returns None. Errors are those of `last_warnings`.
    """
    words = _last("error").split()
    return (words[0], words[1], int(words[2])) if words else None


def _last(what: str) -> str:
    text: bytes = function_of(loaded_plugin(), f"meshlab_spectral_{what}", ())()
    return text.decode()


@functools.cache
def function_of(plugin: Path, name: str, arguments: Sequence[Any]) -> Any:
    """Return a function of the loaded plugin; errors are those of `last_warnings`."""
    try:
        function = getattr(opened(plugin), name)
    except OSError as error:
        raise PluginError(
            f"pymeshlab has loaded another copy of the plugin than {plugin}: call "
            "meshlab_spectral.load() before loading any other copy"
        ) from error
    except AttributeError as error:
        raise PluginError(
            f"the plugin {plugin} is older than this package: rebuild both from the same sources"
        ) from error
    function.restype = ctypes.c_char_p
    function.argtypes = arguments
    return function
