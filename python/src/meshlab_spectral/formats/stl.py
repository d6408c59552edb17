"""STL files, binary and text: coincident corners are merged into one vertex."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from meshlab_spectral._core import first_equal_rows
from meshlab_spectral.errors import UntiledError
from meshlab_spectral.formats.causes import EndsEarlyError, ForeignError, unreadable
from meshlab_spectral.formats.digits import SINGLE, digits_for, precision_warnings
from meshlab_spectral.formats.document import Array, Document, Indices, Part, check_vertices
from meshlab_spectral.formats.normals import following_face_normals
from meshlab_spectral.formats.rows import Between, MeshRows, Rows
from meshlab_spectral.formats.text import BYTE_ORDER_MARK, lines_of, write_patched
from meshlab_spectral.warned import Warned

HEADER, _LOOKED_AT = 84, 1000  # bytes
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_LARGEST_CUT = 1000  # largest ratio of what a file claims to hold to what it holds
_EXCESS = 1 / 20  # trailing bytes that a binary file may have, relative to its size
_KEYWORDS = ["facet", "vertex", "endfacet", "solid", "endsolid"]
_FACET = [0, 1, 1, 1, 2]  # loops left out


@dataclass(kw_only=True)
class _BinaryStl(Document):
    content: bytes
    count: int

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        (part,), (after,) = self.parts, moved
        content = bytearray(self.content)
        rows = np.frombuffer(content, TRIANGLE, self.count, HEADER)
        _move(rows, part.vertices, after, part.faces)
        target.write_bytes(content)
        return precision_warnings(part.vertices, after, target.name)


def _move(rows: Rows, before: Array, after: Array, faces: Indices) -> None:
    """Write corners that have moved into binary facets, and normals that follow."""
    changed = (after != before)[faces]
    np.copyto(rows["corners"], after.astype("<f4")[faces], where=changed)
    with np.errstate(invalid="ignore"):
        normals = rows["normal"].astype(np.float64)
    rows["normal"] = following_face_normals(before, after, faces, normals)


@dataclass(kw_only=True)
class _TextStl(Document):
    content: bytes
    facets: Indices  # byte offsets of their lines
    corners: Indices
    normals: Array

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        (part,), (after,) = self.parts, moved
        before, corners = part.vertices, part.faces.ravel()
        normals = following_face_normals(before, after, part.faces, self.normals)
        changes = [
            (self.corners, 1, before[corners], after[corners], digits_for(before, after)),
            (self.facets, 2, self.normals, normals, SINGLE),
        ]
        with target.open("wb") as file:
            write_patched(file, self.content, changes)
        return []


def read(path: Path) -> Document:
    """Read an STL file; raise MeshFileError when it is damaged."""
    content = path.read_bytes()
    try:
        return _read_text(path, content) if _is_text(content) else _read_binary(path, content)
    except (ValueError, IndexError) as error:
        raise unreadable(path, error) from error


def _is_text(content: bytes) -> bool:
    head = content[: HEADER + _LOOKED_AT].removeprefix(BYTE_ORDER_MARK)
    if len(head) < HEADER:
        return True
    # A binary file may begin with the word solid, like a text file.
    is_whole = len(content) == _size(content)
    return head.isascii() and b"\0" not in head and not is_whole


def _count(content: bytes) -> int:
    """Return the number of triangles that a binary file claims to hold."""
    count: int = struct.unpack_from("<I", content, HEADER - 4)[0]
    return count


def _size(content: bytes) -> int:
    return HEADER + TRIANGLE.itemsize * _count(content)


def _read_binary(path: Path, content: bytes) -> Document:
    count, size = _count(content), len(content)
    if not _size(content) <= size <= _size(content) * (1 + _EXCESS):
        is_cut = size < _size(content) <= _LARGEST_CUT * size
        raise (EndsEarlyError if is_cut else ValueError)(
            f"it claims {count} triangles, which does not match its {size} bytes"
        )
    rows = np.frombuffer(content, TRIANGLE, count, HEADER)
    with np.errstate(invalid="ignore"):  # check_vertices reports non-finite values
        points = rows["corners"].reshape(-1, 3).astype(np.float64)
    part = _connected(path, points)
    contents = ["attribute bytes"] if rows["attribute"].any() else []
    return _BinaryStl(path, [part], contents, content=content, count=count)


def _read_text(path: Path, content: bytes) -> Document:
    lines = lines_of(content, _KEYWORDS, any_case=True)
    has_names = (lines.words[lines.kinds == _KEYWORDS.index("solid")] > 1).any()
    is_ended = (lines.kinds == _KEYWORDS.index("endsolid")).any()
    chosen = lines[lines.kinds <= max(_FACET)]
    del lines
    if not len(chosen):
        raise ForeignError("it has no facets, and is not binary")
    expected = np.resize(np.array(_FACET), len(chosen))
    wrong = chosen.kinds != expected
    if wrong.any():
        first = int(np.argmax(wrong))
        keyword = _KEYWORDS[expected[first]]
        raise chosen.fault(
            first, f"line {chosen.line_number(first)} does not begin with {keyword!r}"
        )
    if len(chosen) % len(_FACET):
        raise EndsEarlyError("it ends within a facet")
    facets, corners = chosen[:: len(_FACET)], chosen[chosen.kinds == _KEYWORDS.index("vertex")]
    text = f"{path.name} ends without endsolid: it may have been cut off"
    return _TextStl(
        path,
        [_connected(path, corners.numbers(path, 1))],
        ["names of solids"] if has_names else [],
        [] if is_ended else [Warned("cut_file", text)],
        content=content,
        facets=facets.starts,
        corners=corners.starts,
        normals=facets.numbers(path, 2),
    )


def _connected(path: Path, points: Array) -> Part:
    """Merge coincident corners; every three of `points` are the corners of a triangle."""
    if not len(points):
        raise ValueError("it has no triangles")
    check_vertices(path, points)
    first = first_equal_rows(points)
    is_new = first == np.arange(len(points))
    index = np.cumsum(is_new) - 1
    return Part("", points[is_new], index[first].reshape(-1, 3))


class _StlRows(MeshRows):
    is_joined_by_position: ClassVar[bool] = True

    @property
    def vertices(self) -> int:
        return self.faces // 2

    def columns(self, numbers: Indices | slice, kind: str = "positions") -> Array:
        if isinstance(numbers, slice):
            numbers = np.arange(numbers.start, min(numbers.stop, self.points))
        return self.block["corners"][numbers // 3, numbers % 3].astype(np.float64, order="F")

    def triangles(self, begin: int, end: int) -> Indices:
        return np.arange(3 * begin, 3 * end).reshape(-1, 3)

    def written(
        self, begin: int, end: int, moved: Between, normals: Between, is_wide: bool
    ) -> Rows:
        rows = np.array(self.block[begin:end], TRIANGLE)
        before = rows["corners"].reshape(-1, 3).astype(np.float64)
        after = before.copy()
        where, new = moved(3 * begin, 3 * end)
        after[where] = new
        _move(rows, before, after, np.arange(len(before)).reshape(-1, 3))
        return rows


def open_rows(path: Path) -> MeshRows:
    """Open a binary STL file; raise UntiledError if it is none."""
    with path.open("rb") as file:
        head = file.read(HEADER)
    count = _count(head)
    if path.stat().st_size != _size(head) or not count:
        raise UntiledError(f"{path.name} is not a binary STL file: convert it to binary PLY first")
    block = np.memmap(path, TRIANGLE, "r", HEADER, count)
    return _StlRows(path=path, points=3 * count, faces=count, block=block, begin=HEADER)
