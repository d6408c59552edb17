"""Loading the plugin into pymeshlab."""

import os
import sys
from pathlib import Path

from meshlab_spectral import _core
from meshlab_spectral.errors import PluginError
from meshlab_spectral.plugin.failed_calls import kept_when_failed
from meshlab_spectral.plugin.handle import let_signals_interrupt

FILTER_NAME = "apply_coord_spectral_filter_fractional"
DENOISE_NAME = "apply_coord_spectral_denoise"
# The plugin's filters: name in MeshLab's menus and scripts -> Python name.
FILTERS = {one["name"]: one["python_name"] for one in _core.filters()}
PLUGIN_VARIABLE = "MESHLAB_SPECTRAL_PLUGIN"
PYMESHLAB_VERSION = "2025.7.post1"


def library_name(plugin: str, platform: str = sys.platform) -> str:
    """Return the file name of a plugin's library, named like MeshLab's own on the platform."""
    return f"{plugin}.dll" if platform == "win32" else f"lib{plugin}.so"


_INSTALLED = Path(__file__).parent / library_name("filter_spectral")
_loaded: Path | None = None
_REINSTALL = "install this package again: pip install --force-reinstall ./python"


def load() -> None:
    """Load the plugin into pymeshlab; a second call changes nothing.

    Its filters are then methods of `pymeshlab.MeshSet`, like MeshLab's own:
    `ms.apply_coord_spectral_filter_fractional(...)`. The environment variable
    MESHLAB_SPECTRAL_PLUGIN overrides the plugin that comes with this package.

    Raises
    ------
    PluginError
        When the plugin is missing, damaged, or built for another MeshLab version or precision, or
        when pymeshlab is missing or of another version.
    """
    global _loaded
    try:
        import pymeshlab
    except ImportError as error:
        raise PluginError(_pymeshlab_missing(error)) from error
    if FILTER_NAME not in pymeshlab.filter_list():
        _check_pymeshlab_version()
        path = plugin_path()
        try:
            pymeshlab.load_plugin(str(path))
        except pymeshlab.PyMeshLabException as error:
            raise PluginError(_refused(path, str(error))) from error
        _loaded = path
        let_signals_interrupt(path)
    # pymeshlab only creates methods on import, for the filters it knows by then.
    for name in pymeshlab.filter_list():
        if not hasattr(pymeshlab.MeshSet, name):
            method = kept_when_failed(name, pymeshlab.bind_function(name))
            setattr(pymeshlab.MeshSet, name, method)


def plugin_path() -> Path:
    """Return the path of the plugin: named by the environment variable, or that of this package.

    Raises PluginError when that file does not exist.
    """
    named = os.environ.get(PLUGIN_VARIABLE)
    # No fallback if the named file is missing: using another plugin silently would be worse.
    path = Path(named).absolute() if named else _INSTALLED
    if path.is_file():
        return path
    if named:
        raise PluginError(
            f"no plugin at {path}, named by the environment variable {PLUGIN_VARIABLE}: "
            "correct the variable, or unset it to use the plugin that comes with this package"
        )
    raise PluginError(
        f"no plugin at {path}: {_REINSTALL}, or set the environment variable "
        f"{PLUGIN_VARIABLE} to the path of a {_INSTALLED.name}"
    )


def loaded_plugin() -> Path:
    """Return the path that `load` has loaded, or would load."""
    return _loaded or plugin_path()


def _check_pymeshlab_version() -> None:
    from importlib.metadata import version  # a slow import

    installed = version("pymeshlab")
    if installed != PYMESHLAB_VERSION:
        raise PluginError(
            f"pymeshlab {installed} is installed, but the plugin is built for pymeshlab "
            f"{PYMESHLAB_VERSION}: pip install pymeshlab=={PYMESHLAB_VERSION}"
        )


def _pymeshlab_missing(error: ImportError) -> str:
    if isinstance(error, ModuleNotFoundError):
        return "this needs pymeshlab: pip install 'meshlab-spectral[meshlab]'"
    # Usual cause on a server: the wheel needs the system's OpenGL libraries.
    return (
        f"pymeshlab cannot be imported ({error}): if a library is missing, install it; on Debian: "
        "apt-get install libgl1 libopengl0"
    )


def _refused(path: Path, reason: str) -> str:
    if "precision" in reason:
        why = "is built for the other floating-point precision of MeshLab"
        remedy = f"pymeshlab needs the double-precision build; {_REINSTALL}"
    elif "version" in reason and "different" in reason:
        why = "is built for another version of MeshLab"
        remedy = f"pymeshlab {PYMESHLAB_VERSION} needs the build for MeshLab 2025.07; {_REINSTALL}"
    else:
        why = "is not a plugin that MeshLab can load"
        remedy = f"the file may be damaged, or a library it needs is missing; {_REINSTALL}"
    detail = " ".join(reason.split())
    return f"the plugin {path} {why}: {remedy}. MeshLab says: {detail}"
