"""Opening a mesh file as a document, by its extension or its first bytes."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from meshlab_spectral.documents.document import Document

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
}
# FreeSurfer names a surface by what it is, such as lh.pial or lh.pial.T1: it is known by its first
# bytes. These endings are searched for in folders by name, too.
FREE_SURFER = "freesurfer"
TRIANGLES = b"\xff\xff\xfe"
FREE_SURFER_ENDINGS = frozenset({"inflated", "pial", "smoothwm", "sphere", "white"})
PATCHED = frozenset(_MODULES) | FREE_SURFER_ENDINGS


def ending_of(name: str) -> str:
    """Return the extension of a file name, in its original case and without the dot."""
    stem, dot, ending = name.rpartition(".")
    if ending.lower() == "gz" and stem.lower().endswith(".gii"):
        return name[-len("gii.gz") :]
    return ending if stem and dot else ""


def format_of(path: Path) -> str | None:
    """Return the format as which `open_document` reads a file: an extension, or FREE_SURFER.

    None if it does not know it.
    """
    ending = ending_of(path.name).lower()
    if ending in _MODULES:
        return ending
    return FREE_SURFER if ending in FREE_SURFER_ENDINGS or is_free_surfer(path) else None


def is_free_surfer(path: Path) -> bool:
    """Whether a file begins as a surface of FreeSurfer; false if it cannot be read."""
    try:
        with path.open("rb") as file:
            return file.read(len(TRIANGLES)) == TRIANGLES
    except OSError:
        return False


def open_document(path: Path) -> Document:
    """Read a mesh file of one of the formats that `format_of` tells.

    Raises MeshFileError when it is damaged, or holds something that cannot be read, and
    MissingPackageError when its format needs the extra "formats", which is not installed.
    """
    module = _MODULES.get(ending_of(path.name).lower(), "brain")
    document: Document = import_module(f"meshlab_spectral.documents.{module}").read(path)
    return document
