"""The versions a result may depend on."""

from __future__ import annotations

import functools
import hashlib
import platform
from pathlib import Path

from meshlab_spectral import _core


@functools.cache
def versions() -> dict[str, str]:
    """Return the versions of this package, pymeshlab and Python, and the core's SHA-256.

    pymeshlab's is empty if it is not installed.
    """
    from importlib.metadata import PackageNotFoundError, version  # a slow import

    try:
        pymeshlab = version("pymeshlab")
    except PackageNotFoundError:
        pymeshlab = ""
    return {
        "meshlab_spectral": version("meshlab-spectral"),
        "core": hashlib.sha256(Path(_core.__file__).read_bytes()).hexdigest(),
        "pymeshlab": pymeshlab,
        "python": platform.python_version(),
    }
