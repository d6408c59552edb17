"""VTK files: legacy .vtk, and XML .vtp and .vtu.

The numbers of points and normals are replaced where they lie; every other byte stays.
"""

from __future__ import annotations

import base64
import re
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, Literal, NamedTuple
from urllib.parse import unquote
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.documents.digits import SINGLE, digits_for, single_holds
from meshlab_spectral.documents.document import (
    Array,
    Document,
    Indices,
    Part,
    check_vertices,
    unreadable,
    unsupported,
)
from meshlab_spectral.documents.normals import following_normals
from meshlab_spectral.documents.polygons import triangles

_EXTRACT = "extract its surface first (in ParaView: Filters > Extract Surface), and save it as .vtp"


def read(path: Path) -> Document:
    """Read a mesh of points and cells.

    Raises
    ------
    MeshFileError
        When it is damaged, or holds volume cells, several pieces, or no mesh at all.
    """
    data = path.read_bytes()
    try:
        content = _read_xml(path, data) if _is_xml(data) else _read_legacy(path, data)
        return _document(path, content)
    except ValueError as error:
        raise unreadable(path, error) from error


# Numbers in a file, and how they are replaced.


class Edit(NamedTuple):
    """Bytes of a file, from `begin` to `end`, that become others."""

    begin: int
    end: int
    text: bytes


def edited(data: bytes, edits: Sequence[Edit]) -> bytes:
    """Return a file's bytes with `edits`, which do not overlap."""
    pieces, position = [], 0
    for edit in sorted(edits):
        pieces += [data[position : edit.begin], edit.text]
        position = edit.end
    return b"".join([*pieces, data[position:]])


def floats(text: bytes) -> Array:
    """Return the numbers of a text."""
    words = text.split()
    return np.fromiter(map(float, words), np.float64, len(words))


def with_numbers(text: bytes, before: Array, after: Array, digits: int) -> bytes:
    """Return a text with other numbers; what has not changed keeps its bytes.

    Parameters
    ----------
    text
        Numbers, separated by white space.
    before, after
        Its numbers as they are, and as they shall be.
    digits
        How many significant digits the new ones get.
    """
    pieces = re.split(rb"(\s+)", text)
    first = 0 if pieces[0] else 2
    before, after = before.ravel(), after.ravel()
    changed = np.flatnonzero((before != after) & ~np.isnan(after))
    for place, number in zip(changed.tolist(), after[changed].tolist(), strict=True):
        pieces[first + 2 * place] = b"%.*g" % (digits, number)
    return b"".join(pieces)


def _as_text(text: bytes, kind: np.dtype[Any]) -> Array:
    """Numbers of a text, as they are in a type."""
    with np.errstate(over="ignore", invalid="ignore"):  # what does not fit is found when checked
        return floats(text).astype(kind).astype(np.float64)


def _as_bytes(data: bytes, kind: np.dtype[Any]) -> Array:
    with np.errstate(invalid="ignore"):
        return np.frombuffer(data, kind).astype(np.float64)


@dataclass(frozen=True)
class _Stored:
    """Vectors in a file, and where they lie."""

    data: bytes = field(repr=False)
    begin: int
    end: int
    values: Array  # n x 3
    kind: np.dtype[Any]
    names: tuple[str, str]  # of single and double precision
    declared: tuple[int, int]  # where the file says one of them
    ranges: Sequence[tuple[int, int]]  # where the range of their lengths may stand
    encode: Callable[[bytes], bytes] | None  # None: as text

    @property
    def is_real(self) -> bool:
        return self.kind.kind == "f"

    def edits(self, after: Array, double: bool) -> Iterator[Edit]:
        """Yield what changes in the file when the vectors change."""
        kind = np.dtype("f8" if double else "f4").newbyteorder(self.kind.byteorder)
        yield Edit(self.begin, self.end, self._encoded(after, kind))
        if kind != self.kind:
            yield Edit(*self.declared, self.names[double].encode())
        length = np.linalg.norm(after, axis=1)
        for pattern, place in product(_RANGES, self.ranges):
            for match in pattern.finditer(self.data, *place):
                yield Edit(*match.span(1), b"%.17g" % length.min())
                yield Edit(*match.span(2), b"%.17g" % length.max())

    def _encoded(self, after: Array, kind: np.dtype[Any]) -> bytes:
        if self.encode is not None:
            return self.encode(after.astype(kind).tobytes())
        digits = digits_for(self.values, after) if kind.itemsize == 8 else SINGLE
        return with_numbers(self.data[self.begin : self.end], self.values, after, digits)


# VTK keeps the least and largest length of an array's vectors with it, and trusts them.
_RANGES = (
    re.compile(rb'\sRangeMin="([^"]*)"\s+RangeMax="([^"]*)"'),
    re.compile(
        rb'<InformationKey\s+name="L2_NORM(?:_FINITE)?_RANGE"[^>]*>\s*<Value\s+index="0">\s*'
        rb'([^<\s]*)\s*</Value>\s*<Value\s+index="1">\s*([^<\s]*)\s*<'
    ),
    re.compile(rb"NAME L2_NORM(?:_FINITE)?_RANGE LOCATION \w+\s+DATA 2 (\S+) (\S+)\s"),
)


# What both kinds of files hold.

_EMPTY, _VERTEX, _VERTICES, _LINE, _LINES, _TRIANGLE, _STRIP, _POLYGON, _QUAD = (*range(8), 9)


@dataclass(frozen=True)
class _Cells:
    """Cells in their order: all their corners, and the size and type of each."""

    corners: Indices
    sizes: Indices
    types: Indices

    def having(self, *types: int) -> NDArray[np.bool_]:
        return np.isin(self.types, types)

    def corners_of(self, chosen: NDArray[np.bool_]) -> Indices:
        return self.corners[np.repeat(chosen, self.sizes)]

    def contents(self) -> list[str]:
        shown = {
            "points": self.having(_VERTEX, _VERTICES),
            "lines": self.having(_LINE, _LINES),
            "strips": self.having(_STRIP),
            "polygons": self.having(_POLYGON, _QUAD) & (self.sizes > 3),
        }
        return [name for name, chosen in shown.items() if chosen.any()]


@dataclass
class _Content:
    """What a file holds."""

    data: bytes
    points: _Stored
    cells: _Cells
    normals: list[_Stored]
    cell_normals: list[_Stored]
    quality: Array | None
    names: list[str]
    blob: int = 0  # where appended data begin
    offsets: list[tuple[int, int, int]] = field(default_factory=list)  # into it: where, and which


@dataclass(kw_only=True)
class _VtkDocument(Document):
    content: _Content
    owners: Indices  # the cell of each triangle

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        data, warnings = self.content.data, []
        before, after = self.parts[0].vertices, moved[0]
        if not np.array_equal(before, after):
            double = self._double(after)
            if double and self.content.points.kind.itemsize < 8:
                warnings = [f"{target.name}: its points get double precision to hold the result"]
            data = edited(data, self._edits(before, after, double))
        target.write_bytes(data)
        return warnings

    def _double(self, after: Array) -> bool:
        points = self.content.points
        kept = points.is_real and points.kind.itemsize == 8
        return kept or not single_holds(self.parts[0].vertices, after)

    def _edits(self, before: Array, after: Array, double: bool) -> list[Edit]:
        faces, content = self.parts[0].faces, self.content
        edits = list(content.points.edits(after, double))
        for stored in content.normals:
            new = following_normals(before, after, faces, stored.values)
            edits += stored.edits(new, stored.kind.itemsize == 8)
        for stored in content.cell_normals:
            new = _cell_normals(before, after, faces, self.owners, stored.values)
            edits += stored.edits(new, stored.kind.itemsize == 8)
        return [*edits, *_shifted(content, edits)]


def _shifted(content: _Content, edits: Sequence[Edit]) -> Iterator[Edit]:
    """Yield new offsets of appended arrays, which lie behind others that have grown or shrunk."""
    for begin, end, offset in content.offsets:
        place = content.blob + offset
        growths = (len(e.text) - e.end + e.begin for e in edits if content.blob <= e.begin < place)
        if growth := sum(growths):
            yield Edit(begin, end, b"%d" % (offset + growth))


def _cell_normals(
    before: Array, after: Array, faces: Indices, owners: Indices, normals: Array
) -> Array:
    """Return the normals of cells; those that have moved stay on the side where they were."""
    old, new = (_areas(shape, faces, owners, len(normals)) for shape in (before, after))
    new[np.einsum("ij,ij->i", old, normals) < 0] *= -1
    length = np.linalg.norm(new, axis=1)
    chosen = np.zeros(len(normals), dtype=bool)
    chosen[owners[(before[faces] != after[faces]).any(axis=(1, 2))]] = True
    chosen &= length > 0
    result = normals.copy()
    result[chosen] = new[chosen] / length[chosen, None]
    return result


def _areas(vertices: Array, faces: Indices, owners: Indices, cells: int) -> Array:
    """Vector areas of cells, twice."""
    P = vertices[faces]
    areas = np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0])
    return np.column_stack([np.bincount(owners, areas[:, c], minlength=cells) for c in range(3)])


def _document(path: Path, content: _Content) -> Document:
    vertices, cells = content.points.values, content.cells
    if content.points.kind.itemsize == 1:
        raise ValueError("its points are single bytes")
    check_vertices(path, vertices)
    _check_cells(path, cells, len(vertices))
    n, m = len(vertices), len(cells.types)
    for stored, count in [(s, n) for s in content.normals] + [(s, m) for s in content.cell_normals]:
        if len(stored.values) != count:
            raise ValueError(f"it has {len(stored.values)} normals for {count} points or cells")
    if content.quality is not None and len(content.quality) != n:
        raise ValueError(f"it has {len(content.quality)} scalars for {n} points")
    faces, owners = _surface(cells, vertices)
    if not len(faces):
        raise unsupported(path, "holds no polygons and no strips", "name a file with a surface")
    return _VtkDocument(
        path=path,
        parts=[Part("", vertices, faces, content.quality)],
        contents=content.names + cells.contents(),
        content=content,
        owners=owners,
    )


def _check_cells(path: Path, cells: _Cells, points: int) -> None:
    known = cells.having(
        _EMPTY, _VERTEX, _VERTICES, _LINE, _LINES, _TRIANGLE, _STRIP, _POLYGON, _QUAD
    )
    if not known.all():
        kind = cells.types[~known][0]
        raise unsupported(path, f"has volume or curved cells (of VTK's type {kind})", _EXTRACT)
    wrong = (cells.corners < 0) | (cells.corners >= points)
    if wrong.any():
        raise ValueError(f"a cell refers to point {cells.corners[wrong][0]}, of {points}")


def _surface(cells: _Cells, vertices: Array) -> tuple[Indices, Indices]:
    """Triangles of polygons and strips, m x 3, and the cell of each."""
    polygons, strips = cells.having(_TRIANGLE, _POLYGON, _QUAD), cells.having(_STRIP)
    faces = triangles(cells.corners_of(polygons), cells.sizes[polygons], vertices)
    strip_corners = cells.corners_of(strips)[_strip_triangles(cells.sizes[strips])]
    cell = np.concatenate([np.flatnonzero(polygons), np.flatnonzero(strips)])
    owners = np.repeat(cell, np.maximum(cells.sizes[cell] - 2, 0))
    return np.concatenate([faces, strip_corners]), owners


def _strip_triangles(sizes: Indices) -> Indices:
    """Triangles of strips as positions of corners; every other one is turned."""
    counts = np.maximum(sizes - 2, 0)
    step = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    first = np.repeat(np.cumsum(sizes) - sizes, counts) + step
    odd = step % 2
    return np.column_stack([first, first + 1 + odd, first + 2 - odd])


def _sizes(ends: Indices, corners: int) -> Indices:
    """Sizes of cells from where each ends."""
    sizes = np.diff(ends, prepend=0)
    if ((sizes < 0) | (sizes > corners)).any() or sizes.sum() != corners:
        raise ValueError(f"the offsets of its cells do not fit their {corners} corners")
    return sizes


def _cells(groups: dict[int, tuple[Indices, Indices]]) -> _Cells:
    """Cells of a PolyData, whose order does not depend on that in the file."""
    ordered = [(kind, *groups[kind]) for kind in _POLY_DATA if kind in groups]
    none = np.empty(0, dtype=np.int64)
    return _Cells(
        np.concatenate([none, *(corners for _, corners, _ in ordered)]),
        np.concatenate([none, *(sizes for _, _, sizes in ordered)]),
        np.concatenate([none, *(np.full(len(sizes), kind) for kind, _, sizes in ordered)]),
    )


_POLY_DATA = (_VERTICES, _LINES, _POLYGON, _STRIP)


# Legacy files.

_LEGACY_KINDS = {
    "bit": "u1",
    "char": "i1",
    "signed_char": "i1",
    "unsigned_char": "u1",
    "short": "i2",
    "unsigned_short": "u2",
    "int": "i4",
    "unsigned_int": "u4",
    "long": "i8",
    "unsigned_long": "u8",
    "float": "f4",
    "double": "f8",
    "vtkidtype": "i4",
    **{
        f"vtktype{sign}int{8 * size}": f"{sign or 'i'}{size}"
        for sign in ("", "u")
        for size in (1, 2, 4, 8)
    },
}
_LEGACY_GROUPS = {
    "vertices": _VERTICES,
    "lines": _LINES,
    "polygons": _POLYGON,
    "triangle_strips": _STRIP,
}
_COMPONENTS = {
    "vectors": 3,
    "normals": 3,
    "tensors": 9,
    "tensors6": 6,
    "global_ids": 1,
    "pedigree_ids": 1,
    "edge_flags": 1,
}
_BLANK = np.isin(np.arange(256), list(b" \t\r\n\v\f"))


class _Block(NamedTuple):
    """Numbers in a legacy file."""

    begin: int
    end: int
    kind: str


@dataclass
class _Cursor:
    """A place in a legacy file."""

    data: bytes
    position: int = 0
    text: bool = False

    def line(self) -> list[str]:
        """Words of the next line that has any; none at the end of the file."""
        words: list[bytes] = []
        while not words and self.position < len(self.data):
            end = self.data.find(b"\n", self.position) % (len(self.data) + 1)
            words = self.data[self.position : end].split()
            self.position = end + 1
        return [word.decode("utf-8", "replace") for word in words]

    def follows(self, word: bytes) -> bool:
        return re.compile(rb"\s*" + word, re.IGNORECASE).match(self.data, self.position) is not None

    def block(self, kind: str, count: int) -> _Block:
        """Skip an array."""
        begin, kind = self.position, kind.lower()
        if count < 0:
            raise ValueError(f"an array has {count} numbers")
        if kind in ("string", "utf8_string"):
            self._skip_strings(count)
        elif kind not in _LEGACY_KINDS:
            raise ValueError(f'VTK has no type "{kind}"')
        elif self.text:
            self.position = self._after_words(count)
        else:
            bits = 1 if kind == "bit" else 8 * np.dtype(_LEGACY_KINDS[kind]).itemsize
            self.position += (count * bits + 7) // 8
        if self.position > len(self.data):
            raise ValueError(f"it ends before the {count} numbers that begin at byte {begin}")
        return _Block(begin, self.position, kind)

    def _after_words(self, count: int) -> int:
        last = int(np.searchsorted(self._ends, self.position, "right")) + count - 1
        if last >= len(self._ends):
            return len(self.data) + 1
        return int(self._ends[last]) if count else self.position

    @cached_property
    def _ends(self) -> Indices:
        """Where words end."""
        blank = _BLANK[np.frombuffer(self.data, dtype=np.uint8)]
        return np.flatnonzero(~blank & np.append(blank[1:], True)) + 1

    def _skip_strings(self, count: int) -> None:
        while count and self.position < len(self.data):
            count -= 1
            if self.text:
                self.position = self.data.find(b"\n", self.position) % len(self.data) + 1
            else:  # the first two bits tell how many bytes the length has: 8, 4, 2 or 1
                size = 8 >> (self.data[self.position] >> 6)
                length = int.from_bytes(self.data[self.position : self.position + size], "big")
                self.position += size + length % (1 << (8 * size - 2))
        self.position += count  # behind the end, if one is missing


class _Legacy:
    """Reads the sections of a legacy file, one after the other."""

    def __init__(self, path: Path, data: bytes) -> None:
        self.path, self.data = path, data
        self.cursor = _Cursor(data)
        self.owner, self.count = "field", 0
        self.points: _Stored | None = None
        self.groups: dict[int, tuple[Indices, Indices]] = {}
        self.cells: tuple[Indices, Indices] | None = None
        self.types = np.empty(0, dtype=np.int64)
        self.normals: dict[str, list[_Stored]] = {"point": [], "cell": [], "field": []}
        self.scalars: Array | None = None
        self.has_scalars = False
        self.names: list[str] = []

    def content(self) -> _Content:
        self._header()
        while words := self.cursor.line():
            try:
                self._section(words[0].lower(), words[1:])
            except IndexError as error:
                raise ValueError(f'words are missing at "{" ".join(words)[:60]}"') from error
            except ValueError as error:
                raise ValueError(f'{error}, at "{" ".join(words)[:60]}"') from error
        if self.points is None:
            raise ValueError("it has no points")
        cells = _cells(self.groups)
        if self.cells is not None:
            if len(self.types) != len(self.cells[1]):
                raise ValueError(f"{len(self.cells[1])} cells have {len(self.types)} types")
            cells = _Cells(*self.cells, self.types)
        return _Content(
            self.data,
            self.points,
            cells,
            self.normals["point"],
            self.normals["cell"],
            self.scalars,
            self.names,
        )

    def _header(self) -> None:
        first = self.data.find(b"\n") + 1
        self.cursor.position = self.data.find(b"\n", first) + 1  # the title may be empty
        encoding, dataset = (" ".join(self.cursor.line()).lower() for _ in range(2))
        known = self.data.startswith(b"# vtk DataFile") and encoding in ("ascii", "binary")
        if not known or not dataset.startswith("dataset"):
            raise ValueError("its first lines are not those of a VTK file")
        if dataset not in ("dataset polydata", "dataset unstructured_grid"):
            kind = dataset.removeprefix("dataset").strip().upper()
            raise unsupported(self.path, f"holds the dataset {kind}", _EXTRACT)
        self.cursor.text = encoding == "ascii"

    def _section(self, keyword: str, words: list[str]) -> None:
        if keyword in ("point_data", "cell_data"):
            self.owner, self.count = keyword.removesuffix("_data"), int(words[0])
        elif keyword == "points":
            self.points = self._stored(words[1], int(words[0]))
        elif keyword in _LEGACY_GROUPS:
            self.groups[_LEGACY_GROUPS[keyword]] = self._polygons(int(words[0]), int(words[1]))
        elif keyword == "cells":
            self.cells = self._polygons(int(words[0]), int(words[1]))
        elif keyword == "cell_types":
            self.types = self._integers("int", int(words[0]))
        elif keyword == "field":
            self._field(int(words[1]))
        elif keyword == "metadata":
            self._metadata()
        else:
            self._attribute(keyword, words)

    def _attribute(self, keyword: str, words: list[str]) -> None:
        if keyword == "lookup_table":
            self.cursor.block("float" if self.cursor.text else "unsigned_char", 4 * int(words[1]))
            return
        self.names.append(f"{self.owner} data {unquote(words[0])}")
        if keyword == "scalars":
            self._scalars(words[1], int(words[2]) if len(words) > 2 else 1)
        elif keyword == "color_scalars":
            self.has_scalars |= self.owner == "point"
            kind = "float" if self.cursor.text else "unsigned_char"
            self.cursor.block(kind, self.count * int(words[1]))
        elif keyword == "texture_coordinates":
            self.cursor.block(words[2], self.count * int(words[1]))
        elif keyword == "normals" and words[1].lower() in ("float", "double"):
            self.normals[self.owner].append(self._stored(words[1], self.count))
        elif keyword in _COMPONENTS:
            self.cursor.block(words[1], self.count * _COMPONENTS[keyword])
        else:
            raise ValueError("no section of a VTK file begins so")

    def _scalars(self, kind: str, components: int) -> None:
        if self.cursor.follows(b"LOOKUP_TABLE"):
            self.cursor.line()
        block = self.cursor.block(kind, self.count * components)
        if self.owner == "point" and not self.has_scalars:
            self.has_scalars = True
            if components == 1 and block.kind not in ("bit", "string"):
                self.scalars = self._numbers(block)

    def _field(self, arrays: int) -> None:
        while arrays > 0:
            words = self.cursor.line()
            if words == ["METADATA"]:
                self._metadata()
                continue
            self.names.append(f"{self.owner} data {unquote(words[0])}")
            self.cursor.block(words[3], int(words[1]) * int(words[2]))
            arrays -= 1

    def _metadata(self) -> None:
        end = re.compile(rb"\n[ \t\r]*(?:\n|\Z)").search(self.data, self.cursor.position - 1)
        self.cursor.position = end.end() if end else len(self.data)

    def _stored(self, kind: str, count: int) -> _Stored:
        end = self.cursor.position - 1
        declared = self.data.rindex(kind.encode(), 0, end)
        block = self.cursor.block(kind, 3 * count)
        return _Stored(
            self.data,
            block.begin,
            block.end,
            self._numbers(block).reshape(-1, 3),
            self._kind(block),
            ("float", "double"),
            (declared, declared + len(kind)),
            self._range_place(),
            None if self.cursor.text else bytes,
        )

    def _range_place(self) -> list[tuple[int, int]]:
        begin = self.cursor.position
        if not self.cursor.follows(b"METADATA"):
            return []
        self.cursor.line()
        self._metadata()
        return [(begin, self.cursor.position)]

    def _kind(self, block: _Block) -> np.dtype[Any]:
        return np.dtype(">" + _LEGACY_KINDS[block.kind])

    def _numbers(self, block: _Block) -> Array:
        numbers = self.data[block.begin : block.end]
        return (
            _as_text(numbers, self._kind(block))
            if self.cursor.text
            else _as_bytes(numbers, self._kind(block))
        )

    def _integers(self, kind: str, count: int) -> Indices:
        return self._numbers(self.cursor.block(kind, count)).astype(np.int64)

    def _polygons(self, first: int, second: int) -> tuple[Indices, Indices]:
        """Corners and sizes of cells."""
        if not self.cursor.follows(b"OFFSETS"):
            return _interleaved(self._integers("int", second), first)
        ends = self._integers(self.cursor.line()[1], first)
        words = self.cursor.line()
        if words[0].lower() != "connectivity":
            raise ValueError("cells have offsets, but no connectivity")
        corners = self._integers(words[1], second)
        return corners, _sizes(ends[1:], len(corners))


def _interleaved(numbers: Indices, cells: int) -> tuple[Indices, Indices]:
    """Corners and sizes of cells of which each begins with its size."""
    listed = numbers.tolist()
    heads, place = [], 0
    while place < len(listed) and listed[place] >= 0:
        heads.append(place)
        place += listed[place] + 1
    if len(heads) != cells or place != len(listed):
        raise ValueError(f"{len(listed)} numbers are not those of {cells} cells")
    return np.delete(numbers, heads), numbers[heads]


def _read_legacy(path: Path, data: bytes) -> _Content:
    return _Legacy(path, data).content()


# XML files.


@dataclass(eq=False)
class Element:
    """An element of an XML file.

    Attributes
    ----------
    tag
        Where its start tag lies in the file's bytes.
    begin, end
        Where its text lies, up to the first child.
    behind
        Where its end tag begins.
    """

    name: str
    attributes: dict[str, str]
    parent: Element | None
    tag: tuple[int, int]
    begin: int
    end: int = -1
    behind: int = -1

    def count(self, attribute: str) -> int:
        """Return an attribute that is a number; without it 0."""
        return int(self.attributes.get(attribute, "0"))


_TAG = re.compile(rb"""<[^\s/>]+(?:\s+[^\s=]+\s*=\s*(?:"[^"]*"|'[^']*'))*\s*/?>""")


def elements(data: bytes) -> list[Element]:
    """Return the elements of an XML file in their order, and where they lie.

    Raises
    ------
    ValueError
        When it is not well-formed.
    """
    found: list[Element] = []
    within: list[Element] = []
    parser = expat.ParserCreate()

    def start(name: str, attributes: dict[str, str]) -> None:
        tag = _TAG.match(data, parser.CurrentByteIndex)
        if tag is None:
            raise ValueError("its XML is not in UTF-8")
        parent = within[-1] if within else None
        if parent and parent.end < 0:
            parent.end = tag.start()
        found.append(Element(name, attributes, parent, tag.span(), tag.end()))
        within.append(found[-1])

    def end(_: str) -> None:
        element = within.pop()
        element.behind = max(element.begin, parser.CurrentByteIndex)
        element.end = element.behind if element.end < 0 else element.end

    def entity(name: str, *_: object) -> None:
        raise ValueError(f"its XML declares the entity {name}")

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.EntityDeclHandler = entity
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, LookupError) as error:  # the latter for an unknown encoding
        raise ValueError(f"its XML: {error}") from error
    return found


def children(found: Sequence[Element], parent: Element, *names: str) -> list[Element]:
    """Return the elements within `parent` that have one of `names`."""
    return [element for element in found if element.parent is parent and element.name in names]


# Data compress by less than this, except to attack who unpacks them.
_LARGEST_RATIO = 1100
_USUAL_BLOCK = 1 << 15


def unzipped(data: bytes, size: int) -> bytes:
    """Return what zlib has compressed, which must have `size` bytes."""
    if size > _LARGEST_RATIO * len(data):
        raise ValueError(f"{len(data)} compressed bytes cannot be {size}")
    unpacker = zlib.decompressobj()
    try:
        result = unpacker.decompress(data, size + 1)
    except zlib.error as error:
        raise ValueError(f"compressed data are damaged, {error}") from error
    if len(result) != size or not unpacker.eof:
        raise ValueError(f"compressed data do not have the {size} bytes that they should")
    return result


@dataclass(frozen=True)
class _Packing:
    """How a file packs arrays: first numbers that tell the sizes, then blocks of data."""

    word: np.dtype[Any]
    compressed: bool
    block: int = _USUAL_BLOCK  # bytes before they are compressed

    def unpacked(self, raw: bytes) -> tuple[bytes, int, int]:
        """Return data, the size of their blocks, and how many of the bytes they take."""
        if not self.compressed:
            end = self.word.itemsize + self._words(raw, 0, 1)[0]
            if end > len(raw):
                raise ValueError("an array is cut off")
            return raw[self.word.itemsize : end], self.block, end
        count, block, last = self._words(raw, 0, 3)
        sizes = self._words(raw, 3, count)
        place = (3 + count) * self.word.itemsize
        pieces = []
        for number, size in enumerate(sizes, 1):
            whole = last if last and number == count else block
            pieces.append(unzipped(raw[place : place + size], whole))
            place += size
        return b"".join(pieces), block or _USUAL_BLOCK, place

    def _words(self, raw: bytes, first: int, count: int) -> list[int]:
        size = self.word.itemsize
        if (first + count) * size > len(raw):
            raise ValueError("an array is cut off")
        words: list[int] = np.frombuffer(raw, self.word, count, first * size).tolist()
        return words

    def packed(self, data: bytes) -> tuple[bytes, bytes]:
        """Return sizes and blocks."""
        if not self.compressed:
            return self._header([len(data)]), data
        pieces = [
            zlib.compress(data[begin : begin + self.block])
            for begin in range(0, len(data), self.block)
        ]
        sizes = [len(piece) for piece in pieces]
        header = self._header([len(pieces), self.block, len(data) % self.block, *sizes])
        return header, b"".join(pieces)

    def _header(self, words: list[int]) -> bytes:
        return np.array(words, dtype=self.word).tobytes()

    def raw(self, data: bytes) -> bytes:
        return b"".join(self.packed(data))

    def base64(self, data: bytes) -> bytes:
        """Pack as VTK does: sizes of compressed blocks apart."""
        header, blocks = self.packed(data)
        if self.compressed:
            return base64.b64encode(header) + base64.b64encode(blocks)
        return base64.b64encode(header + blocks)


def from_base64(text: bytes) -> bytes:
    """Return the bytes of one or several base64 texts, one after the other."""
    try:
        return b"".join(base64.b64decode(part) for part in re.findall(rb"[^=]+=*", text))
    except ValueError as error:
        raise ValueError(f"base64 data are damaged, {error}") from error


_APPENDED = re.compile(rb'<AppendedData[^>]*\bencoding\s*=\s*["\'](\w+)["\'][^>]*>\s*_')
_XML_GROUPS = {"Verts": _VERTICES, "Lines": _LINES, "Polys": _POLYGON, "Strips": _STRIP}


def _is_xml(data: bytes) -> bool:
    return data[:200].lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<")


class _Xml:
    """Reads arrays of an XML file."""

    def __init__(self, path: Path, data: bytes) -> None:
        self.path, self.data = path, data
        match = _APPENDED.search(data)
        self.blob = match.end() if match else len(data)
        self.blob_end = max(data.rfind(b"</AppendedData"), self.blob)
        self.raw = match is not None and match[1] == b"raw"
        # Appended data need not be XML.
        self.found = elements(data[: self.blob] + data[self.blob_end :])
        self.root = self.found[0]
        self.arrays = [e for e in self.found if e.name in ("DataArray", "Array")]
        big = self.root.attributes.get("byte_order") == "BigEndian"
        self.order: Literal["<", ">"] = ">" if big else "<"
        self.packing = self._packing()
        offsets = {e.count("offset") for e in self.arrays if self._is_appended(e)}
        self.offsets = sorted(offsets | {self.blob_end - self.blob})

    def _packing(self) -> _Packing:
        attributes = self.root.attributes
        compressor = attributes.get("compressor", "")
        if compressor not in ("", "vtkZLibDataCompressor"):
            raise unsupported(
                self.path,
                f"is compressed by {compressor}",
                "save it with the compressor ZLib, or without compression",
            )
        size = "u8" if attributes.get("header_type") == "UInt64" else "u4"
        return _Packing(np.dtype(self.order + size), bool(compressor))

    def content(self) -> _Content:
        kind = self.root.attributes.get("type")
        if self.root.name != "VTKFile" or kind not in ("PolyData", "UnstructuredGrid"):
            raise unsupported(self.path, f"holds {kind or self.root.name}", _EXTRACT)
        (grid,) = children(self.found, self.root, kind)
        pieces = children(self.found, grid, "Piece")
        if len(pieces) != 1:
            raise unsupported(
                self.path,
                f"holds {len(pieces)} pieces",
                "save it in one piece (in ParaView: Filters > Merge Blocks)",
            )
        point_data, cell_data = (self._child(pieces[0], name) for name in ("PointData", "CellData"))
        scalars = self._active(point_data, "Scalars")
        return _Content(
            self.data,
            self._points(pieces[0]),
            self._poly_data(pieces[0]) if kind == "PolyData" else self._grid(pieces[0]),
            self._normals(point_data),
            self._normals(cell_data),
            self._numbers(scalars[0]) if scalars and _components(scalars[0]) == 1 else None,
            [*self._names(grid), *self._names(pieces[0])],
            self.blob,
            [
                (*_value_place(self.data, e, b"offset"), e.count("offset"))
                for e in self.arrays
                if self._is_appended(e)
            ],
        )

    def _child(self, parent: Element, name: str) -> Element | None:
        found = children(self.found, parent, name)
        return found[0] if found else None

    def _within(self, parent: Element | None) -> list[Element]:
        return [e for e in self.arrays if parent and e.parent is parent]

    def _active(self, parent: Element | None, attribute: str) -> list[Element]:
        name = parent.attributes.get(attribute) if parent else None
        arrays = self._within(parent)
        return [e for e in arrays if name and e.attributes.get("Name") == name][:1]

    def _names(self, parent: Element) -> list[str]:
        owners = children(self.found, parent, "PointData", "CellData", "FieldData")
        return [
            f"{owner.name.removesuffix('Data').lower()} data {array.attributes.get('Name', '')}"
            for owner in owners
            for array in self._within(owner)
        ]

    def _points(self, piece: Element) -> _Stored:
        arrays = self._within(self._child(piece, "Points"))
        if len(arrays) != 1:
            raise ValueError(f"it has {len(arrays)} arrays of points")
        stored = self._stored(arrays[0])
        if len(stored.values) != piece.count("NumberOfPoints"):
            raise ValueError(
                f"it has {len(stored.values)} points of {piece.count('NumberOfPoints')}"
            )
        return stored

    def _normals(self, parent: Element | None) -> list[_Stored]:
        stored = [self._stored(array) for array in self._active(parent, "Normals")]
        return [normals for normals in stored if normals.is_real]

    def _poly_data(self, piece: Element) -> _Cells:
        groups = {}
        for name, kind in _XML_GROUPS.items():
            group = self._child(piece, name)
            if group is not None and self._within(group):
                corners, ends = self._integers(group, "connectivity", "offsets")
                groups[kind] = corners, _sizes(ends, len(corners))
        return _cells(groups)

    def _grid(self, piece: Element) -> _Cells:
        group = self._child(piece, "Cells")
        if group is None:
            raise ValueError("it has no cells")
        corners, ends, types = self._integers(group, "connectivity", "offsets", "types")
        if len(types) != len(ends):
            raise ValueError(f"{len(ends)} cells have {len(types)} types")
        return _Cells(corners, _sizes(ends, len(corners)), types)

    def _integers(self, parent: Element, *names: str) -> list[Indices]:
        arrays = {e.attributes.get("Name"): e for e in self._within(parent)}
        missing = [name for name in names if name not in arrays]
        if missing:
            raise ValueError(f"{parent.name} has no {missing[0]}")
        return [self._numbers(arrays[name]).astype(np.int64) for name in names]

    def _is_appended(self, array: Element) -> bool:
        return array.attributes.get("format") == "appended"

    def _is_text(self, array: Element) -> bool:
        return array.attributes.get("format", "ascii") == "ascii"

    def _place(self, array: Element) -> tuple[int, int]:
        """Where the bytes of an array lie, perhaps with what follows it."""
        if not self._is_appended(array):
            return array.begin, array.end
        offset = array.count("offset")
        following = [o for o in self.offsets if o > offset]
        if offset < 0 or not following:
            raise ValueError(f"the array {array.attributes.get('Name')} is cut off")
        return self.blob + offset, self.blob + following[0]

    def _unpacked(self, array: Element) -> tuple[bytes, int, tuple[int, int]]:
        """Bytes of an array, the size of their blocks, and where they lie."""
        begin, end = self._place(array)
        text = self.data[begin:end]
        if self.raw and self._is_appended(array):
            data, block, size = self.packing.unpacked(text)
            return data, block, (begin, begin + size)
        begin, end = end - len(text.lstrip()), begin + len(text.rstrip())
        data, block, _ = self.packing.unpacked(from_base64(text))
        return data, block, (begin, end)

    def _kind(self, array: Element) -> np.dtype[Any]:
        kind = array.attributes.get("type", "")
        if not re.fullmatch("U?Int(8|16|32|64)|Float(32|64)", kind):
            raise ValueError(f'the array {array.attributes.get("Name")} has the type "{kind}"')
        return np.dtype(kind.lower()).newbyteorder(self.order)

    def _numbers(self, array: Element) -> Array:
        kind = self._kind(array)
        try:
            if self._is_text(array):
                return _as_text(self.data[array.begin : array.end], kind)
            return _as_bytes(self._unpacked(array)[0], kind)
        except ValueError as error:
            raise ValueError(f"in the array {array.attributes.get('Name')} {error}") from error

    def _stored(self, array: Element) -> _Stored:
        numbers, place, encode = self._numbers(array), (array.begin, array.end), None
        if len(numbers) % 3:
            raise ValueError(f"the array {array.attributes.get('Name')} has {len(numbers)} numbers")
        if not self._is_text(array):
            _, block, place = self._unpacked(array)
            packing = replace(self.packing, block=block)
            as_raw = self.raw and self._is_appended(array)
            encode = packing.raw if as_raw else packing.base64
        return _Stored(
            self.data,
            *place,
            numbers.reshape(-1, 3),
            self._kind(array),
            ("Float32", "Float64"),
            _value_place(self.data, array, b"type"),
            [array.tag, (array.end, array.behind)],
            encode,
        )


def _components(array: Element) -> int:
    return int(array.attributes.get("NumberOfComponents", "1"))


def _value_place(data: bytes, element: Element, attribute: bytes) -> tuple[int, int]:
    """Where the value of an attribute lies."""
    pattern = re.compile(rb"\s" + attribute + rb"\s*=\s*[\"']([^\"']*)")
    match = pattern.search(data, *element.tag)
    if match is None:
        raise ValueError(f"an array has no {attribute.decode()}")
    return match.span(1)


def _read_xml(path: Path, data: bytes) -> _Content:
    return _Xml(path, data).content()
