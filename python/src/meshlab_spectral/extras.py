"""Packages that not every user needs: the extras of this package."""

from __future__ import annotations

from importlib.util import find_spec

from meshlab_spectral.errors import MissingPackageError

# Extra -> the package that tells whether it is installed.
_PACKAGES = {"batch": "distributed", "plots": "matplotlib", "render": "pyvista"}


def check_extras(*extras: str) -> None:
    """Raise MissingPackageError, which says what to install, unless all of `extras` are there."""
    missing = [extra for extra in extras if find_spec(_PACKAGES[extra]) is None]
    if missing:
        packages = " and ".join(_PACKAGES[extra] for extra in missing)
        raise MissingPackageError(
            f"this needs {packages}: pip install 'meshlab-spectral[{','.join(missing)}]'"
        )
