"""The versions a result may depend on."""

from __future__ import annotations

import functools
import hashlib
import platform
from importlib.metadata import version

from meshlab_spectral.errors import PluginError
from meshlab_spectral.plugin.loading import plugin_path


@functools.cache
def versions() -> dict[str, str]:
    """Return the versions of this package, pymeshlab and Python, and the plugin's SHA-256.

    The latter is empty when there is no plugin; `load` then explains why.
    """
    try:
        plugin = hashlib.sha256(plugin_path().read_bytes()).hexdigest()
    except (PluginError, OSError):
        plugin = ""
    return {
        "meshlab_spectral": version("meshlab-spectral"),
        "plugin": plugin,
        "pymeshlab": version("pymeshlab"),
        "python": platform.python_version(),
    }
