"""PLY files: cells of vertices are replaced, and all other bytes stay."""

from __future__ import annotations

import io
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyListProperty, PlyParseError, PlyProperty

from meshlab_spectral.documents.digits import digits_for, rounding_told
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
from meshlab_spectral.documents.side_files import copy_side_files

Bytes = NDArray[np.uint8]
Columns = Mapping[str, Indices]

_LONGEST_HEADER = 2**20  # bytes; comments may make it long
_WORDS_AT_ONCE = 2**18
_AXES, _NORMALS = ("x", "y", "z"), ("nx", "ny", "nz")
_CORNERS = ("vertex_indices", "vertex_index")
_QUALITIES = ("quality", "confidence")  # to MeshLab, which prefers the first
_READ = {*_AXES, *_NORMALS, *_CORNERS, *_QUALITIES}
_TEXTURE = "TextureFile"
_MARK = "VCGLIB generated"  # a comment in whatever MeshLab writes
_KNOWN = {
    "normals": set(_NORMALS),
    "colours": {"red", "green", "blue", "alpha"}
    | {f"diffuse_{colour}" for colour in ("red", "green", "blue")},
    "texture coordinates": {"s", "t", "u", "v", "texture_u", "texture_v", "texture_s", "texture_t"}
    | {"texcoord", "texnumber"},
    "quality": {"quality"},
}
_SPACE = np.isin(np.arange(256), list(b" \t\n\r\v\f"))


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: tuple[PlyProperty, ...]

    def error(self, row: int, what: str) -> ValueError:
        return ValueError(f"element {self.name!r}: row {row}: {what}")

    def types(self) -> dict[str, str]:
        """Return the NumPy types of its numbers by name, without the lists."""
        return {
            one.name: one.val_dtype
            for one in self.properties
            if not isinstance(one, PlyListProperty)
        }


@dataclass(frozen=True)
class _Header:
    data: bytes
    newline: bytes
    is_text: bool
    byte_order: str
    elements: dict[str, _Element]  # those with properties
    comments: list[str]

    def textures(self) -> list[str]:
        named = (comment.split(None, 1) for comment in self.comments)
        return [words[1] for words in named if words[:1] == [_TEXTURE] and len(words) == 2]

    def widened(self, names: Iterable[str]) -> bytes:
        """Return its bytes with the type double for properties of vertices."""
        lines = self.data.split(self.newline)
        element = b""
        for i, line in enumerate(lines):
            words = line.split()
            if words[:1] == [b"element"]:
                element = words[1]
            elif (element, words[:1]) == (b"vertex", [b"property"]) and words[-1].decode() in names:
                lines[i] = line.replace(words[1], b"double", 1)
        return self.newline.join(lines)


@dataclass(frozen=True)
class _Cells:
    """Numbers of the vertices in a file, n x k: coordinates and normals, in its order.

    `begins` and `ends` are their bytes.
    """

    names: list[str]
    types: list[str]
    values: Array
    begins: Indices
    ends: Indices

    def of(self, names: Sequence[str]) -> list[int]:
        """Return the columns of three names; none if it lacks them."""
        held = set(names) <= set(self.names)
        return [self.names.index(name) for name in names] if held else []


@dataclass(kw_only=True)
class PlyDocument(Document):
    """A PLY file, with the places of its coordinates and normals."""

    content: bytes
    header: _Header
    cells: _Cells

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:  # noqa: D102
        (after,) = moved
        content, warnings = self.content, list[str]()
        if (after != self.parts[0].vertices).any():
            content, warnings = self._moved(after)
        target.write_bytes(content)
        return warnings + copy_side_files(self.path, target, self.header.textures())

    def _moved(self, after: Array) -> tuple[bytes, list[str]]:
        before, cells = self.parts[0].vertices, self.cells
        values = cells.values.copy()
        values[:, cells.of(_AXES)] = after
        normals = cells.of(_NORMALS)
        if normals:
            values[:, normals] = following_normals(
                before, after, self.parts[0].faces, cells.values[:, normals]
            )
        reason = self._reason_to_widen(after)
        types = [
            "f8" if reason and name in _AXES else type_
            for name, type_ in zip(cells.names, cells.types, strict=True)
        ]
        if self.header.is_text:
            data = self._with_words(values, digits_for(before, after))
        else:
            data = self._with_rows(values, types)
        header = self.header.widened(_AXES) if reason else self.header.data
        warning = f"coordinates are written in double precision, since {reason}"
        return header + data[len(self.header.data) :], [warning] if reason else []

    def _reason_to_widen(self, after: Array) -> str | None:
        """Why the types of the coordinates do not hold them; None if they do."""
        types = {self.cells.types[c] for c in self.cells.of(_AXES)}
        if any(type_[0] in "iu" for type_ in types):
            return f"{self.path.name} holds them as integers"
        if "f4" not in types:
            return None
        return rounding_told(self.parts[0].vertices, after)

    def _with_words(self, values: Array, digits: int) -> bytes:
        """Return the file with other words for what has changed."""
        changed = (values != self.cells.values) & ~np.isnan(values)
        words = [b"%.*g" % (digits, value) for value in values[changed].tolist()]
        return _replaced(
            self.content,
            self.cells.begins[changed],
            self.cells.ends[changed],
            b"".join(words),
            np.array([len(word) for word in words]),
        )

    def _with_rows(self, values: Array, types: list[str]) -> bytes:
        """Return the file with other binary numbers."""
        order = self.header.byte_order
        row = np.dtype([(str(c), order + type_) for c, type_ in enumerate(types)])
        data = np.empty(len(values), row)
        for c in range(len(types)):
            data[str(c)] = values[:, c]
        sizes = np.tile([np.dtype(type_).itemsize for type_ in types], len(values))
        begins, ends = self.cells.begins.ravel(), self.cells.ends.ravel()
        return _replaced(self.content, begins, ends, data.tobytes(), sizes)


def _replaced(content: bytes, begins: Indices, ends: Indices, new: bytes, sizes: Indices) -> bytes:
    """Replace ascending stretches of bytes by those of `new`, which have `sizes`."""
    grown = sizes - (ends - begins)
    starts = begins + np.cumsum(grown) - grown
    result = np.empty(len(content) + int(grown.sum()), np.uint8)
    inside = _inside(starts, starts + sizes, len(result))
    result[inside] = np.frombuffer(new, np.uint8)
    result[~inside] = _bytes(content)[~_inside(begins, ends, len(content))]
    return result.tobytes()


def _inside(begins: Indices, ends: Indices, size: int) -> NDArray[np.bool_]:
    steps = np.zeros(size + 1, np.int8)
    steps[begins] += 1
    steps[ends] -= 1
    return np.cumsum(steps[:-1], dtype=np.int8).view(np.bool_)


def _bytes(content: bytes) -> Bytes:
    return np.frombuffer(content, np.uint8)


def read(path: Path) -> PlyDocument:
    """Read a PLY file.

    Raises
    ------
    MeshFileError
        When it is damaged, has no vertices, or holds a range grid.
    """
    content = path.read_bytes()
    try:
        header = _read_header(content)
        vertex = header.elements.get("vertex", _Element("vertex", 0, ()))
        missing = [axis for axis in _AXES if axis not in vertex.types()]
        if missing:
            raise ValueError(f"its vertices have no {', '.join(missing)}")
        body = (_Text if header.is_text else _Binary)(content, header)
        cells = _read_cells(body, vertex)
        vertices = cells.values[:, cells.of(_AXES)]
        check_vertices(path, vertices)
        faces, are_triangles = _read_faces(body, vertices)
    except (PlyParseError, ValueError) as error:
        raise unreadable(path, error) from error
    if "range_grid" in header.elements and not len(faces):
        raise unsupported(path, "holds a range grid", "open it in MeshLab and export it as .ply")
    return PlyDocument(
        path=path,
        parts=[Part("", vertices, faces, _read_quality(body, vertex))],
        contents=_contents(header, are_triangles),
        content=content,
        header=header,
        cells=cells,
    )


def _read_header(content: bytes) -> _Header:
    """Read the header; with plyfile, which gets neither its counts nor its comments."""
    first = re.match(rb"ply[ \t]*(\r\n|\n|\r)", content)
    newline = b"\r" if first and first[1] == b"\r" else b"\n"
    ending = rb"[\r\n][ \t]*end_header[ \t]*" + (b"\r" if newline == b"\r" else rb"\r?\n")
    end = re.compile(ending).search(content, 0, _LONGEST_HEADER)
    if not first or not end:
        raise ValueError("it has no PLY header")
    data = content[: end.end()]
    lines, counts, comments = [], list[int](), list[str]()
    for line in data.split(newline):
        words = line.split()
        if words[:1] == [b"element"] and len(words) == 3:
            counts.append(int(words[2]))
            lines.append(b"element %b 0" % words[1])
        elif words[:1] in ([b"comment"], [b"obj_info"]):
            comments.append(_decoded(line.strip()[len(words[0]) :].strip()))
            lines.append(b"comment")
        else:
            lines.append(line.strip())
    ply = PlyData.read(io.BytesIO(b"\n".join(lines)))
    elements = [
        _Element(one.name, count, one.properties) for one, count in zip(ply, counts, strict=True)
    ]
    _check(elements)
    named = {element.name: element for element in elements if element.properties}
    return _Header(data, newline, ply.text, ply.byte_order, named, comments)


def _decoded(comment: bytes) -> str:
    try:
        return comment.decode()
    except UnicodeDecodeError:
        return comment.decode("latin-1")


def _check(elements: list[_Element]) -> None:
    for element in elements:
        if element.count < 0:
            raise ValueError(f"element {element.name!r} has the count {element.count}")
        for one in element.properties:
            if isinstance(one, PlyListProperty) and one.len_dtype[0] == "f":
                raise ValueError(f"property {one.name!r}: the length of its lists is no integer")


class _Body(ABC):
    """The numbers of a file, and where they are: bytes, or words of a text."""

    def __init__(self, content: bytes, header: _Header) -> None:
        self.content = content
        self.begin = len(header.data)
        self.elements = header.elements
        self.order = header.byte_order
        self.columns = dict[str, Columns]()
        start = self.prepare()
        for name, element in self.elements.items():
            self.columns[name], start = self.rows(element, start)

    @abstractmethod
    def prepare(self) -> int:
        """Return where the first element begins."""

    @abstractmethod
    def rows(self, element: _Element, start: int) -> tuple[Columns, int]:
        """Return the places of an element's properties that are read, and where it ends."""

    @abstractmethod
    def width(self, type_: str) -> int: ...

    @abstractmethod
    def numbers(self, type_: str) -> NDArray[Any]:
        """Return what would be a number of that type at each place."""

    @abstractmethod
    def spans(self, type_: str, places: Indices) -> tuple[Indices, Indices]:
        """Return the first bytes of numbers and those after them."""

    def columns_from(self, element: _Element, begins: Indices) -> tuple[Columns, Indices]:
        """Return the places of properties in rows that begin there, and where the rows end."""
        places, here = dict[str, Indices](), begins
        for one in element.properties:
            if one.name in _READ:
                places[one.name] = here
            if isinstance(one, PlyListProperty):
                sizes = self.sizes(one, here)
                here = here + self.width(one.len_dtype) + sizes * self.width(one.val_dtype)
            else:
                here = here + self.width(one.val_dtype)
        return places, here

    def sizes(self, one: PlyListProperty, places: Indices) -> Indices:
        """Return the lengths of lists; an impossible one as one that leads out of the file."""
        numbers, limit = self.numbers(one.len_dtype), len(self.content)
        sizes = numbers[np.minimum(places, len(numbers) - 1)]
        return np.where((sizes >= 0) & (sizes < limit), sizes, limit).astype(np.int64)

    def lists(self, one: PlyListProperty, places: Indices) -> tuple[NDArray[Any], Indices]:
        """Return what lists hold, one after the other, and their lengths."""
        sizes = self.sizes(one, places)
        width = self.width(one.val_dtype)
        first = places + self.width(one.len_dtype) - (np.cumsum(sizes) - sizes) * width
        each = np.repeat(first, sizes) + np.arange(sizes.sum()) * width
        return self.numbers(one.val_dtype)[each], sizes


class _Text(_Body):
    """Places are words; rows are lines, of which those without a word do not count."""

    def prepare(self) -> int:
        data = _bytes(self.content)[self.begin :]
        edges = np.flatnonzero(np.diff(_SPACE[data], prepend=True, append=True)) + self.begin
        self.word_begins, self.word_ends = edges[::2], edges[1::2]
        breaks = np.flatnonzero((data == ord("\n")) | (data == ord("\r"))) + self.begin
        after = np.searchsorted(self.word_begins, breaks)
        firsts = np.concatenate([[0], after, [len(self.word_begins)]])
        self.lines = firsts[np.diff(firsts, prepend=-1) > 0]
        used = min(sum(element.count for element in self.elements.values()), len(self.lines) - 1)
        self.values = self._parsed(int(self.lines[used]))
        return 0

    def _parsed(self, count: int) -> Array:
        values = np.empty(count)
        for begin in range(0, count, _WORDS_AT_ONCE):
            end = min(begin + _WORDS_AT_ONCE, count)
            words = self.content[self.word_begins[begin] : self.word_ends[end - 1]].split()
            try:
                values[begin:end] = np.fromiter(map(float, words), np.float64, end - begin)
            except ValueError:
                raise self._no_number(words, begin) from None
        return values

    def _no_number(self, words: list[bytes], begin: int) -> ValueError:
        """Return the error for the first of `words` that is no number."""
        wrong = next(i for i, word in enumerate(words) if not _is_number(word))
        row = int(np.searchsorted(self.lines, begin + wrong, side="right")) - 1
        for element in self.elements.values():
            if row < element.count:
                break
            row -= element.count
        return element.error(row, f"{words[wrong][:40].decode('latin-1')!r} is not a number")

    def rows(self, element: _Element, start: int) -> tuple[Columns, int]:
        stop = start + element.count
        if stop > len(self.lines) - 1:
            raise element.error(len(self.lines) - 1 - start, f"the file ends, of {element.count}")
        columns, ends = self.columns_from(element, self.lines[start:stop])
        wrong = ends != self.lines[start + 1 : stop + 1]
        if wrong.any():
            raise element.error(int(np.argmax(wrong)), "its line has too many or too few numbers")
        return columns, stop

    def width(self, type_: str) -> int:
        return 1

    def numbers(self, type_: str) -> NDArray[Any]:
        return self.values

    def spans(self, type_: str, places: Indices) -> tuple[Indices, Indices]:
        return self.word_begins[places], self.word_ends[places]


def _is_number(word: bytes) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


class _Binary(_Body):
    """Places are bytes."""

    def prepare(self) -> int:
        return self.begin

    def rows(self, element: _Element, start: int) -> tuple[Columns, int]:
        if not element.count:
            return self.columns_from(element, np.zeros(0, np.int64))[0], start
        stride = self._walk(element, start, 1)[1] - start
        end = start + element.count * stride
        has_lists = len(element.types()) < len(element.properties)
        if end <= len(self.content):
            if not has_lists and not _READ & element.types().keys():
                return {}, end
            begins = start + stride * np.arange(element.count)
            columns, ends = self.columns_from(element, begins)
            if (ends == begins + stride).all():
                return columns, end
        elif not has_lists:
            raise element.error((len(self.content) - start) // stride, "the file ends")
        begins, end = self._walk(element, start, element.count)
        return self.columns_from(element, begins)[0], end

    def _walk(self, element: _Element, start: int, count: int) -> tuple[Indices, int]:
        """Return where rows with lists of several lengths begin, and where the last ends."""
        steps = [
            (self.numbers(one.len_dtype), self.width(one.len_dtype), self.width(one.val_dtype))
            if isinstance(one, PlyListProperty)
            else (None, self.width(one.val_dtype), 0)
            for one in element.properties
        ]
        begins, here, limit = [], start, len(self.content)
        for row in range(count):
            begins.append(here)
            for sizes, head, each in steps:
                if sizes is not None and here < len(sizes):
                    size = int(sizes[here])
                    here += size * each if size >= 0 else limit
                here += head
            if here > limit:
                raise element.error(row, "the file ends")
        return np.array(begins, dtype=np.int64), here

    def width(self, type_: str) -> int:
        return np.dtype(type_).itemsize

    def numbers(self, type_: str) -> NDArray[Any]:
        count = max(len(self.content) - self.width(type_) + 1, 0)
        return np.ndarray((count,), self.order + type_, self.content, strides=(1,))

    def spans(self, type_: str, places: Indices) -> tuple[Indices, Indices]:
        return places, places + self.width(type_)


def _read_cells(body: _Body, vertex: _Element) -> _Cells:
    types, places = vertex.types(), body.columns["vertex"]
    names = set(_AXES)
    if all(types.get(name, "i")[0] == "f" for name in _NORMALS):
        names |= set(_NORMALS)
    types = {name: type_ for name, type_ in types.items() if name in names}
    spans = [body.spans(type_, places[name]) for name, type_ in types.items()]
    return _Cells(
        list(types),
        list(types.values()),
        np.column_stack([_column(body, type_, places[name]) for name, type_ in types.items()]),
        *(np.column_stack(side) for side in zip(*spans, strict=True)),
    )


def _column(body: _Body, type_: str, places: Indices) -> Array:
    return body.numbers(type_)[places].astype(np.float64)


def _read_quality(body: _Body, vertex: _Element) -> Array | None:
    types = vertex.types()
    for name in _QUALITIES:
        if types.get(name, "i")[0] == "f":
            return _column(body, types[name], body.columns["vertex"][name])
    return None


def _read_faces(body: _Body, vertices: Array) -> tuple[Indices, bool]:
    """Return the triangles, and whether all faces of the file are triangles."""
    for name in ("face", "tristrips"):
        element = body.elements.get(name, _Element(name, 0, ()))
        lists = (one for one in element.properties if one.name in _CORNERS)
        one = next((one for one in lists if isinstance(one, PlyListProperty)), None)
        if one is None or not element.count:
            continue
        numbers, sizes = body.lists(one, body.columns[name][one.name])
        corners = _corners(element, numbers, sizes, len(vertices))
        if name == "face":
            return triangles(corners, sizes, vertices), bool((sizes == 3).all())
        return _strip_triangles(np.insert(corners, np.cumsum(sizes), -1)), True
    return np.zeros((0, 3), np.int64), True


def _corners(element: _Element, numbers: NDArray[Any], sizes: Indices, vertices: int) -> Indices:
    """Check numbers of vertices; -1 begins another strip."""
    least = -1 if element.name == "tristrips" else 0
    wrong = ~((numbers >= least) & (numbers < vertices) & (numbers == np.floor(numbers)))
    if wrong.any():
        first = int(np.argmax(wrong))
        row = int(np.searchsorted(np.cumsum(sizes), first, side="right"))
        raise element.error(row, f"it refers to vertex {numbers[first]:g}, of {vertices}")
    return numbers.astype(np.int64)


def _strip_triangles(corners: Indices) -> Indices:
    """Split strips, each of which ends in -1, into triangles that face the same side."""
    corners = np.append(corners, [-1, -1, -1])
    place = np.arange(len(corners))
    begin = np.maximum.accumulate(np.where(corners < 0, place + 1, 0))
    odd = (place - begin)[:-2] % 2 == 1
    windows = np.lib.stride_tricks.sliding_window_view(corners, 3)
    split = np.where(odd[:, None], windows[:, [1, 0, 2]], windows)
    return split[(windows >= 0).all(axis=1)]


def _contents(header: _Header, are_triangles: bool) -> list[str]:
    names = {
        name: [one.name for one in header.elements[name].properties]
        for name in ("vertex", "face")
        if name in header.elements
    }
    contents = [
        word for word, known in _KNOWN.items() if any(known & set(held) for held in names.values())
    ]
    others = [element for element in header.elements.values() if element.count]
    others = [one for one in others if one.name not in ("vertex", "face", "tristrips", "edge")]
    present = {
        "polygons": not are_triangles,
        "edges": "edge" in header.elements and header.elements["edge"].count > 0,
        "comments": any(
            comment != _MARK and comment.split()[:1] not in ([], [_TEXTURE])
            for comment in header.comments
        ),
        "texture names": bool(header.textures()),
    }
    contents += [word for word, is_there in present.items() if is_there]
    known = set().union(*_KNOWN.values(), _AXES, _CORNERS)
    for name, held in names.items():
        unknown = [one for one in held if one not in known]
        if unknown:
            contents.append(f"{name} properties {', '.join(unknown)}")
    return contents + [f"element {one.name}" for one in others]
