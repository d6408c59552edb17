"""The formats by the extensions of their files: what is known of each beyond its module."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple


class Format(NamedTuple):
    """A format of mesh files."""

    name: str  # as texts call it
    module: str  # in this folder, with `read(path) -> Document`
    is_text: bool = False  # whether it may be
    is_ended: Callable[[bytes], bool] | None = None  # whether the end of a whole file is there
    in_rows: str = ""  # the module with `open_rows(path) -> MeshRows`
    is_patched: bool = True  # else it is only read


def _holding(word: bytes, within: int = 1000) -> Callable[[bytes], bool]:
    return lambda content: word in content[-within:]


def _is_glb_whole(content: bytes) -> bool:
    return len(content) >= int.from_bytes(content[8:12], "little") > 0


def _ends_in_brace(content: bytes) -> bool:
    return content.rstrip().endswith(b"}")


_VTK, _GIFTI, _ZIP = _holding(b"</VTKFile"), _holding(b"</GIFTI"), _holding(b"PK\5\6", 66000)
_HEIGHT_MAPS = {
    "al3d": "Alicona AL3D",
    "gwy": "Gwyddion",
    "nms": "NanoFocus NMS",
    "opd": "Wyko OPD",
    "plu": "Sensofar PLU",
    "plux": "Sensofar PLUX",
    "sdf": "SDF",
    "sur": "Digital Surf",
    "tif": "GeoTIFF",
    "tiff": "GeoTIFF",
    "tmd": "TrueMap",
    "x3p": "X3P",
}
# Surfaces of FreeSurfer have no extension of their own; see names.py.
FORMATS = {
    "ply": Format("PLY", "ply", is_text=True, in_rows="ply_rows"),
    "obj": Format("OBJ", "obj", is_text=True),
    "off": Format("OFF", "off", is_text=True),
    "stl": Format("STL", "stl", is_text=True, in_rows="stl"),
    "gltf": Format("glTF", "gltf", is_text=True, is_ended=_ends_in_brace),
    "glb": Format("binary glTF", "gltf", is_ended=_is_glb_whole),
    "3mf": Format("3MF", "three_mf", is_ended=_ZIP),
    "vtk": Format("VTK", "vtk", is_text=True),
    "vtp": Format("VTK", "vtk", is_text=True, is_ended=_VTK),
    "vtu": Format("VTK", "vtk", is_text=True, is_ended=_VTK),
    "gii": Format("GIFTI", "brain", is_text=True, is_ended=_GIFTI),
    "gii.gz": Format("GIFTI", "brain"),
    "usd": Format("USD", "usd"),
    "usda": Format("USD", "usd", is_text=True, is_ended=_ends_in_brace),
    "usdc": Format("binary USD", "usd"),
    "usdz": Format("a USD package", "usd", is_ended=_ZIP),
    **{
        ending: Format(name, "height_map", is_patched=False)
        for ending, name in _HEIGHT_MAPS.items()
    },
}
TERRAINS = frozenset({"tif", "tiff"})  # most files with these are textures
