"""The endings of mesh files that pymeshlab reads and writes; it has no list of its own."""

from __future__ import annotations

_BOTH = {"3ds", "3mf", "ctm", "dae", "e57", "obj", "off", "ply", "stl", "wrl", "x3d", "xyz"}
_READ_ONLY = {"apts", "asc", "bre", "fbx", "glb", "gltf", "pdb", "pts", "ptx", "qobj", "tri"}
READABLE = frozenset(_BOTH | _READ_ONLY | {"txt", "vmi", "x3dv"})
WRITABLE = frozenset(_BOTH | {"dxf", "idtf", "json", "nxs", "nxz"})
# Written without an error, and without the faces.
POINTS_ONLY = frozenset({"e57", "xyz"})
# What a folder is searched for. To MeshLab a .txt file is a list of points; it is seldom meant so.
SEARCHED = READABLE - {"txt"}

FALLBACK = "ply"


def ending_of(name: str) -> str:
    """Tell the ending of a file's name, as it is written, without its dot."""
    stem, dot, ending = name.rpartition(".")
    return ending if stem and dot else ""
