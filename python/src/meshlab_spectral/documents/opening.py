"""Opening a mesh file as a document, by its extension."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from meshlab_spectral.documents.document import Document

# Extension -> module with `read(path) -> Document`. Imported late: some need packages of an extra.
# FreeSurfer names a surface by what it is, such as lh.pial.
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
    "inflated": "brain",
    "pial": "brain",
    "smoothwm": "brain",
    "sphere": "brain",
    "white": "brain",
}
PATCHED = frozenset(_MODULES)


def is_patched(path: Path) -> bool:
    """Whether `open_document` knows the extension of a file."""
    return path.suffix[1:].lower() in PATCHED


def open_document(path: Path) -> Document:
    """Read a mesh file of one of the formats in `PATCHED`.

    Raises MeshFileError when it is damaged, or holds something that cannot be read, and
    MissingPackageError when its format needs the extra "formats", which is not installed.
    """
    module = import_module(f"meshlab_spectral.documents.{_MODULES[path.suffix[1:].lower()]}")
    document: Document = module.read(path)
    return document
