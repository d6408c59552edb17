"""Why a mesh file cannot be read, from what is in it: each message says what is true."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.names import FREE_SURFER, ending_of, shown
from meshlab_spectral.formats.table import FORMATS, Format

_LOOKED_AT = 4096  # bytes
_LONGEST = 300  # characters of a reader's reason
_AGAIN = "copy it again, or export it again from the program that made it"
_EMPTY = f"is empty: {_AGAIN}"


class EndsEarlyError(ValueError):
    """A reader has met the end of a file that announces more."""


class MayEndEarlyError(EndsEarlyError):
    """The same, unless the file is damaged, for instance in the size of a list."""


class ForeignError(ValueError):
    """A reader sees by how a file begins that it is of another format."""


class _Kind(NamedTuple):
    """A kind of files, told by how they begin."""

    name: str
    endings: tuple[str, ...]  # of mesh files of this kind; none: not a mesh
    pattern: re.Pattern[bytes]
    remedy: str = ""


def _kind(name: str, endings: str, pattern: bytes, remedy: str = "") -> _Kind:
    return _Kind(name, tuple(endings.split()), re.compile(pattern, re.DOTALL), remedy)


_UNPACK, _NO_MESH = "unpack it first", "name a mesh file"
_XML = rb"\s*(?:<[?!][^>]*>\s*)*"  # before the first element
_KINDS = [
    _kind("PLY", "ply", rb"ply\s*[\r\n]"),
    _kind("binary glTF", "glb", rb"glTF"),
    _kind("a USD package", "usdz", rb"PK\x03\x04.{26}[^\0]{1,200}\.usd[ac]?"),
    _kind("3MF", "3mf", rb"PK\x03\x04.*(?:\[Content_Types\]|3D/|_rels/)"),
    _kind("legacy VTK", "vtk", rb"# vtk DataFile"),
    _kind("VTK PolyData", "vtp", _XML + rb"<VTKFile[^>]*type=.PolyData"),
    _kind("VTK UnstructuredGrid", "vtu", _XML + rb"<VTKFile[^>]*type=.UnstructuredGrid"),
    _kind(
        "a data set of VTK without a surface",
        "",
        _XML + rb"<VTKFile",
        "extract its surface first (in ParaView: Filters > Extract Surface), and save it as .vtp",
    ),
    _kind("GIFTI", "gii", _XML + rb"<GIFTI"),
    _kind("X3P", "x3p", rb"PK\x03\x04.{26}(?:main\.xml|bindata/)"),
    _kind("Digital Surf", "sur", rb"DIGITAL SURF|DSCOMPRESSED"),
    _kind("Gwyddion", "gwy", rb"GWYP"),
    _kind("Wyko OPD", "opd", rb"\x01\x00Directory"),
    _kind("Alicona AL3D", "al3d", rb"AliconaImaging"),
    _kind("SDF", "sdf", rb"[ab]ISO-[12]\.0"),
    _kind("TrueMap", "tmd", rb"Binary TrueMap Data File"),
    _kind("TIFF", "tif tiff", rb"II[*+]\0|MM\0[*+]"),
    _kind("COLLADA", "dae", _XML + rb"<COLLADA"),
    _kind("X3D", "x3d", _XML + rb"<X3D"),
    _kind("VRML", "wrl", rb"#VRML"),
    _kind("FBX", "fbx", rb"Kaydara FBX|; FBX"),
    _kind("E57", "e57", rb"ASTM-E57"),
    _kind(
        "OFF",
        "off",
        rb"\s*(?:#[^\r\n]*[\r\n]\s*)*(?:(?:ST|C|N|4|n)*OFF|(?:st|c|n)*off)(?![A-Za-z])",
    ),
    _kind("text STL", "stl", rb"\s*solid\b[^\r\n]*[\r\n]+\s*facet\b"),
    _kind("glTF", "gltf", rb"\s*\{.*\"asset\""),
    _kind("JSON", "gltf", rb"\s*\{\s*\"", _NO_MESH),
    _kind(
        "a web page",
        "",
        _XML + rb"(?i:<html)",
        "the download has failed: download the mesh itself",
    ),
    _kind(
        "a pointer of Git LFS, not the file itself",
        "",
        rb"version https://git-lfs",
        "fetch it with `git lfs pull`",
    ),
    _kind(
        "an .obj surface of MNI (CIVET), not a Wavefront OBJ",
        "",
        rb"P(?:\s+-?[\d.]+(?:e[-+]?\d+)?){5}\s+\d+\s|p.{20}\0",
        "convert it to GIFTI (.surf.gii) or .ply first",
    ),
    _kind(
        "a surface of FreeSurfer",
        "freesurfer",
        rb"\xff\xff[\xfd\xfe]",
        "give it one of FreeSurfer's names, such as lh.pial",
    ),
    _kind("compressed with gzip", "gii.gz", rb"\x1f\x8b", _UNPACK),
    _kind("binary USD", "usdc usd", rb"PXR-USDC"),
    _kind("USD", "usda usd", rb"#usda"),
    _kind("a ZIP archive", "", rb"PK\x03\x04", _UNPACK),
    _kind("an archive", "", rb"7z\xbc\xaf|Rar!|BZh|\xfd7zXZ|\x28\xb5\x2f\xfd", _UNPACK),
    _kind("a PNG image", "", rb"\x89PNG", _NO_MESH),
    _kind("a JPEG image", "", rb"\xff\xd8\xff", _NO_MESH),
    _kind("a PDF document", "", rb"%PDF", _NO_MESH),
    _kind("an HDF5 file", "", rb"\x89HDF", "export a mesh from it first"),
    _kind("a file of zeros", "", rb"\0{512}", "copy it again: nothing of it has arrived"),
    _kind("XML of another kind", "", rb"\s*<\?xml", _NO_MESH),
    _kind("Wavefront OBJ", "obj", rb"(?:.*[\r\n])?[ \t]*v(?:[ \t]+-?\d[-+\d.e]*){3,}\s"),
]
_FREE_SURFER = Format("a surface of FreeSurfer", "brain")
_COMMAS = re.compile(rb"(?m)^[ \t]*(?:v[nt]?[ \t]+|vertex[ \t]+)?-?\d+,\d+[ \t]+-?\d+,\d+[ \t]")


def unreadable(path: Path, reason: object, ending: str = "") -> MeshFileError:
    """Return the error for a file that a reader has refused, with the cause.

    `reason` is what is wrong in it and where, or the reader's exception; `ending` is the format in
    which it has been read, as an extension, by default that of its name.
    """
    ending = ending or ending_of(path.name).lower()
    ending = ending if ending in FORMATS else FREE_SURFER
    content = path.read_bytes() if path.is_file() else b"?"
    message = shown(" ".join(str(reason).split()), _LONGEST)
    code, text = _cause(content, ending, message, reason)
    return MeshFileError(f"{path} {text}", code)


def _cause(content: bytes, ending: str, message: str, reason: object) -> tuple[str, str]:
    """Return the code, and what follows the name of the file."""
    known = FORMATS.get(ending, _FREE_SURFER)
    name = known.name
    if not content.strip(b" \t\r\n"):
        return "empty", _EMPTY
    if known.is_text and _is_utf16(content):
        return "encoding", "is text in UTF-16: save it in UTF-8 or ASCII"
    kind = _kind_of(content[:_LOOKED_AT])
    if kind and ending not in kind.endings:
        return "foreign", _foreign(kind, name)
    if known.is_text and _COMMAS.search(content):
        return "decimal_commas", "has decimal commas, as in 1,5: write decimal points"
    is_cut = kind is not None and known.is_ended is not None and not known.is_ended(content)
    if is_cut or isinstance(reason, EndsEarlyError):
        damaged = " or is damaged" if isinstance(reason, MayEndEarlyError) else ""
        return "cut_off", f"ends too early ({message}): it was cut off{damaged}; {_AGAIN}"
    if isinstance(reason, ForeignError) or (kind is None and ending in _BEGINS):
        return "foreign", f"is not {name} ({message}): {_NO_MESH}, with its extension"
    return "damaged", (
        f"cannot be read as {name} ({message}): it is damaged, or was written with a mistake; "
        "correct it there, or export it again from the program that made it"
    )


def _foreign(kind: _Kind, name: str) -> str:
    if not kind.endings:
        return f"is {kind.name}: {kind.remedy}"
    remedy = kind.remedy or f"rename it to .{kind.endings[0]}"
    return f"is {kind.name}, not {name}: {remedy}"


def other_kind(path: Path) -> MeshFileError | None:
    """Return the error for a file without a byte, or of another format than its name says."""
    ending = path.suffix[1:].lower()
    with path.open("rb") as file:
        head = file.read(_LOOKED_AT)
    if not head:
        return MeshFileError(f"{path} {_EMPTY}", "empty")
    kind = _kind_of(head)
    if kind is None or ending in kind.endings:
        return None
    return MeshFileError(f"{path} {_foreign(kind, f'.{ending}')}", "foreign")


# Formats whose files can all be told by how they begin.
_BEGINS = {ending for kind in _KINDS for ending in kind.endings} - {"stl", "obj", "gii.gz"}


def _is_utf16(content: bytes) -> bool:
    """Whether there is a byte order mark, or every other byte of ASCII text is zero."""
    has_mark = content[:2] in (b"\xff\xfe", b"\xfe\xff")
    return has_mark or any(
        set(content[k:32:2]) == {0} != set(content[1 - k : 32 : 2]) for k in (0, 1)
    )


def _kind_of(head: bytes) -> _Kind | None:
    head = head.removeprefix(b"\xef\xbb\xbf")  # the byte order mark of UTF-8
    return next((kind for kind in _KINDS if kind.pattern.match(head)), None)


def unsupported(path: Path, what: str, remedy: str) -> MeshFileError:
    """Return the error for a valid file with something that this package does not support."""
    return MeshFileError(
        f"{path} {what}, which meshlab-spectral does not read: {remedy}", "unsupported"
    )
