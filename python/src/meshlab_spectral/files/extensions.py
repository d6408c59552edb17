"""Extensions of mesh files; pymeshlab offers no list of its own."""

from __future__ import annotations

from pathlib import Path

from meshlab_spectral.errors import FormatError
from meshlab_spectral.formats.names import FREE_SURFER, FREE_SURFER_ENDINGS, ending_of
from meshlab_spectral.formats.opening import PATCHED, READ_ONLY, format_of
from meshlab_spectral.formats.table import TERRAINS

_BOTH = {"3ds", "3mf", "ctm", "dae", "e57", "obj", "off", "ply", "stl", "wrl", "x3d", "xyz"}
_BY_MESHLAB = {"apts", "asc", "bre", "fbx", "glb", "gltf", "pdb", "pts", "ptx", "qobj", "tri"}
READABLE = frozenset(_BOTH | _BY_MESHLAB | {"txt", "vmi", "x3dv"} | PATCHED | READ_ONLY)
WRITABLE = frozenset(_BOTH | {"dxf", "idtf", "json", "nxs", "nxz"})
# MeshLab drops the faces in these without an error.
POINTS_ONLY = frozenset({"e57", "xyz"})
# Searched for in folders. MeshLab reads any .txt as a point list, which is rarely intended, and
# most .tif are textures.
SEARCHED = READABLE - TERRAINS - {"txt"}

FALLBACK = "ply"
_GIFTI = ("gii", "gii.gz")


def is_same_format(source: Path, target: Path) -> bool:
    """Whether a file can be written in the format of another by replacing coordinates.

    `source` exists. A surface of FreeSurfer may have any name that is no other format's.
    """
    ending, given = format_of(source), ending_of(target.name).lower()
    if ending == FREE_SURFER:
        return given not in (READABLE | WRITABLE) - FREE_SURFER_ENDINGS
    if ending in _GIFTI:
        return given in _GIFTI
    own = ending or ending_of(source.name).lower()
    return own == given and given not in READ_ONLY


def check_ending(path: Path, what: str, *endings: str) -> None:
    """Raise FormatError, which says `what` the file is, unless its extension is in `endings`."""
    if path.suffix.lower() not in endings:
        *others, last = endings
        names = f"{', '.join(others)} or {last}" if others else last
        raise FormatError(f"{path.name}: {what}, name it {names}")
