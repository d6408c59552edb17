"""Opening a mesh file as a document, by its extension or its first bytes."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from meshlab_spectral.formats.names import (
    FREE_SURFER,
    FREE_SURFER_ENDINGS,
    OTHERS,
    QUADRILATERALS,
    TRIANGLES,
    begin_of,
    ending_of,
)

if TYPE_CHECKING:
    from meshlab_spectral.formats.document import Document

# Extension -> module with `read(path) -> Document`. Imported late: some need packages of an extra.
_MODULES = {
    "ply": "ply",
    "obj": "obj",
    "off": "off",
    "stl": "stl",
    "gltf": "gltf",
    "glb": "gltf",
    "3mf": "three_mf",
    "vtk": "vtk",
    "vtp": "vtk",
    "vtu": "vtk",
    "gii": "brain",
    "gii.gz": "brain",
    **dict.fromkeys(("usd", "usda", "usdc", "usdz"), "usd"),
}
PATCHED = frozenset(_MODULES) | FREE_SURFER_ENDINGS
# Height maps: only read.
INSTRUMENTS = frozenset({"al3d", "gwy", "nms", "opd", "plu", "plux", "sdf", "sur", "tmd", "x3p"})
TERRAINS = frozenset({"tif", "tiff"})
_MODULES |= dict.fromkeys(INSTRUMENTS | TERRAINS, "height_map")


def format_of(path: Path) -> str | None:
    """Return the format as which `open_document` reads a file: an extension, or FREE_SURFER.

    None if it does not know it.
    """
    ending = ending_of(path.name).lower()
    if ending in _MODULES:
        return ending
    is_one = ending in FREE_SURFER_ENDINGS or begin_of(path) in (
        TRIANGLES,
        QUADRILATERALS,
        OTHERS,
    )
    return FREE_SURFER if is_one else None


def open_document(path: Path) -> Document:
    """Read a mesh file of one of the formats that `format_of` tells.

    Raises MeshFileError when it is damaged, or holds something that cannot be read, and
    MissingPackageError when its format needs the extra "formats", which is not installed.
    """
    module = _MODULES.get(ending_of(path.name).lower(), "brain")
    document: Document = import_module(f"meshlab_spectral.formats.{module}").read(path)
    return document
