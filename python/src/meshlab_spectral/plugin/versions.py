"""The versions that a result may depend on."""

from __future__ import annotations

import functools
import hashlib
import platform
from importlib.metadata import version

from meshlab_spectral.errors import PluginError
from meshlab_spectral.plugin.loading import plugin_path


@functools.cache
def versions() -> dict[str, str]:
    """Tell the versions of the package, of pymeshlab and of Python, and the plugin's SHA-256.

    The plugin's is empty where there is none to be loaded: an error that the loading explains.
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
