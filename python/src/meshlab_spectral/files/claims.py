"""What a mesh file claims to hold, against its size: MeshLab would run out of memory, or hang."""

from __future__ import annotations

import struct
from pathlib import Path

from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.ply_header import read_ply_header

STL_HEADER, _STL_TRIANGLE = 84, 50  # bytes of a binary STL
_STL_LOOKED_AT = 1000
# MeshLab reads a binary STL that is longer than it claims by up to this share.
_STL_EXCESS = 1 / 20


def check_claims(source: Path) -> None:
    """Raise MeshFileError when a PLY or STL file claims more than it can hold."""
    ending = source.suffix.lower()
    if ending == ".ply":
        _check_ply(source)
    elif ending == ".stl":
        _check_stl(source)


def stl_triangles(source: Path) -> int | None:
    """Return the number of triangles a binary STL claims to hold; None of a text file."""
    head = _stl_head(source)
    if len(head) < STL_HEADER:
        return None
    count: int = struct.unpack_from("<I", head, STL_HEADER - 4)[0]
    whole = source.stat().st_size == STL_HEADER + _STL_TRIANGLE * count
    is_text = head.isascii() and b"\0" not in head
    return None if is_text and not whole else count


def _stl_head(source: Path) -> bytes:
    """Read what MeshLab looks at to tell a binary STL from a text."""
    with source.open("rb") as file:
        return file.read(STL_HEADER + _STL_LOOKED_AT)


def _check_ply(source: Path) -> None:
    header = read_ply_header(source)
    if header is None:
        return
    is_ascii = header.format_ == "ascii"
    sizes = {one.name: one.least_bytes(is_ascii) for one in header.elements}
    held = source.stat().st_size - header.size
    if sum(sizes.values()) > held + 1:  # the last line of a text may lack its end
        largest = max(header.elements, key=lambda one: sizes[one.name])
        raise _damaged(source, f"{largest.name} elements", largest.count, held)


def _check_stl(source: Path) -> None:
    count = stl_triangles(source)
    size = source.stat().st_size
    if count is None:
        with source.open("rb") as file:
            if size > STL_HEADER and b"\n" not in file.read(2**20):
                raise MeshFileError(
                    f"{source} is a text without lines, not an STL file: the file is damaged; "
                    "export it again from the program that made it"
                )
        return
    claimed = STL_HEADER + _STL_TRIANGLE * count
    # In ASCII alone it is a text to MeshLab, unless it has just the right size.
    excess = 0.0 if _stl_head(source)[STL_HEADER:].isascii() else _STL_EXCESS
    if not claimed <= size <= claimed * (1 + excess):
        raise _damaged(source, "triangles", count, size)


def _damaged(source: Path, what: str, count: int, held: int) -> MeshFileError:
    return MeshFileError(
        f"{source} claims to hold {count} {what}, which does not fit its {held} bytes: the file is "
        "damaged or cut off; copy it anew, or export it again from the program that made it"
    )
