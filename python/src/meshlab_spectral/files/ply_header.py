"""The header of a PLY file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

_LONGEST_HEADER = 2**20  # bytes; comments may make it long
_TYPES = {
    "i1": ("char", "int8"),
    "u1": ("uchar", "uint8"),
    "i2": ("short", "int16"),
    "u2": ("ushort", "uint16"),
    "i4": ("int", "int32"),
    "u4": ("uint", "uint32"),
    "f4": ("float", "float32"),
    "f8": ("double", "float64"),
}
_TYPE_OF = {name: type_ for type_, names in _TYPES.items() for name in names}


@dataclass(frozen=True)
class Property:
    """A property: its name and NumPy type; of a list, the type of its length."""

    name: str
    type_: str
    is_list: bool = False


@dataclass(frozen=True)
class Element:
    """A kind of element, such as "vertex", and how many of them the file claims to hold."""

    name: str
    count: int
    properties: list[Property]

    def least_bytes(self, ascii_: bool) -> int:
        """Return the size of all of them with empty lists."""
        each = (2 if ascii_ else int(one.type_[1]) for one in self.properties)
        return self.count * sum(each)


@dataclass(frozen=True)
class PlyHeader:
    """What a PLY file claims to hold.

    Attributes
    ----------
    format_
        "ascii", "binary_little_endian" or "binary_big_endian".
    elements
        In the order of the file.
    size
        Bytes of the header.
    """

    format_: str
    elements: list[Element]
    size: int


def read_ply_header(path: Path) -> PlyHeader | None:
    """Read the header of a PLY file; None if it is damaged, which MeshLab reports."""
    with path.open("rb") as file:
        head, end, _ = file.read(_LONGEST_HEADER).partition(b"end_header")
        file.seek(len(head) + len(end))
        size = len(head) + len(end) + len(file.readline())
    format_, elements = "", list[Element]()
    try:
        for line in head.decode("latin-1").splitlines():
            words = line.split()
            if words[:1] == ["format"]:
                format_ = words[1]
            elif words[:1] == ["element"]:
                elements.append(Element(words[1], int(words[2]), []))
            elif words[:1] == ["property"]:
                is_list = words[1] == "list"
                type_ = _TYPE_OF[words[2 if is_list else 1]]
                elements[-1].properties.append(Property(words[-1], type_, is_list))
    except (LookupError, ValueError):
        return None
    return PlyHeader(format_, elements, size) if end else None
