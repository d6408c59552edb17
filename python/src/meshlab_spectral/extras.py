"""Packages that not every user needs: the extras of this package."""

from __future__ import annotations

from importlib.util import find_spec

from meshlab_spectral.errors import MissingPackageError

# Extra -> its packages.
_PACKAGES = {
    "cluster": ["distributed"],
    "usd": ["pxr"],
    "draco": ["DracoPy"],
    "formats": ["nibabel", "pyvista"],
    "maps": ["rasterio", "surfalize"],
    "matrices": ["scipy"],
    "meshlab": ["pymeshlab"],
    "plots": ["matplotlib"],
    "render": ["pyvista"],
}


def check_extras(*extras: str) -> None:
    """Raise MissingPackageError, which says what to install, if one of `extras` is missing."""
    lacking = {
        extra: [package for package in _PACKAGES[extra] if find_spec(package) is None]
        for extra in extras
    }
    missing = [extra for extra, packages in lacking.items() if packages]
    if missing:
        packages = " and ".join(sorted({name for names in lacking.values() for name in names}))
        raise MissingPackageError(
            f"this needs {packages}: pip install 'meshlab-spectral[{','.join(missing)}]'"
        )
