"""The MeshLab 2025.07 plugin Spectral Filter (Fractional), for pymeshlab and the shell.

>>> import pymeshlab, meshlab_spectral
>>> meshlab_spectral.load()
>>> ms = pymeshlab.MeshSet()
>>> ms.load_new_mesh("scan.ply")
>>> ms.apply_coord_spectral_filter_fractional(feature_size=pymeshlab.PercentageValue(2))

Each subpackage imports only from those to its left; all of them import `errors` and `extras`:

    formats, plugin <- filters <- files <- workers <- tiles <- batch, figures <- cli
"""

import re
from importlib import import_module
from pathlib import Path
from typing import Any

# Imported on first use, so that the command can handle Ctrl-C without waiting for them.
_EXPORT = re.compile(r"^from (\S+) import (\w+) as", re.MULTILINE)
_STUB = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
_MODULES = {name: module for module, name in _EXPORT.findall(_STUB)}
__all__ = sorted(_MODULES)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("meshlab-spectral")
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__, "__version__"]
