"""The plugin's warnings, in its own words: pymeshlab drops the strings of a filter's report."""

from __future__ import annotations

import ctypes
import functools
import os
from collections.abc import Callable
from pathlib import Path

from meshlab_spectral.errors import PluginError
from meshlab_spectral.plugin.loading import loaded_plugin


def last_warnings() -> list[str]:
    """Return the warnings of the plugin's latest filter run in this thread.

    Returns
    -------
    list of str
        Sentences without the final full stop; empty before the first run and after a failed one.

    Raises
    ------
    PluginError
        When pymeshlab has loaded another copy of the plugin than `load` would, or the plugin is
        older than this package.
    """
    return _warnings_function(loaded_plugin())().decode().splitlines()


@functools.cache
def _warnings_function(plugin: Path) -> Callable[[], bytes]:
    try:
        # NOLOAD: a second copy of the plugin would have no warnings to report.
        library = ctypes.CDLL(str(plugin), mode=os.RTLD_NOW | os.RTLD_NOLOAD)
        function = library.meshlab_spectral_warnings
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
    return function
