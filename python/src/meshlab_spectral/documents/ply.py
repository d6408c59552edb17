"""PLY files: vertex coordinates and normals are replaced, all other bytes are kept."""

from __future__ import annotations

import io
import os
import re
import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyElementParseError, PlyListProperty, PlyParseError

from meshlab_spectral.documents.digits import digits_for, rounding_told, widening_warnings
from meshlab_spectral.documents.document import (
    Array,
    Document,
    Indices,
    Part,
    check_indices,
    check_vertices,
    unreadable,
    unsupported,
)
from meshlab_spectral.documents.normals import following_normals
from meshlab_spectral.documents.polygons import strip_triangles, triangles
from meshlab_spectral.documents.side_files import copy_side_files
from meshlab_spectral.documents.text import Lines, lines_of, write_patched

_AXES, _NORMALS = ("x", "y", "z"), ("nx", "ny", "nz")
_TEXTURE = re.compile(rb"(?m)^[ \t]*comment[ \t]+TextureFile[ \t]+(.*\S)")
_COMMENT = re.compile(rb"(?m)^[ \t]*(comment|obj_info)[ \t]+(?!TextureFile|VCGLIB generated)\S")
_CORNERS = ("vertex_indices", "vertex_index")
_KNOWN = {
    "normals": set(_NORMALS),
    "colours": {"red", "green", "blue", "alpha", "diffuse_red", "diffuse_green", "diffuse_blue"},
    "texture coordinates": {"s", "t", "u", "v", "texture_u", "texture_v", "texcoord", "texnumber"},
    "quality": {"quality"},
}
_SELECTED = 0x20  # VCG's flag
_Rows = np.ndarray[Any, Any]
_Changes = dict[tuple[str, str, str], tuple[Array, Array]]  # before and after


@dataclass(frozen=True, eq=False)
class _Table:
    """The rows of an element."""

    names: list[str]
    columns: dict[str, NDArray[Any]]
    lists: dict[str, tuple[Indices, NDArray[Any]]]  # the size of each row's, and all items
    size: int = 0  # in bytes, if binary
    rows: Lines | _Rows | None = None  # None for binary rows of several sizes


@dataclass(kw_only=True)
class PlyDocument(Document):
    """A PLY file with its bytes and its rows of vertices; those of a binary one are a span."""

    content: bytes
    header: bytes
    ply: PlyData
    rows: Lines | _Rows
    span: slice
    normals: Array | None
    first: dict[tuple[str, str, str], int]  # text: the words before coordinates, and before normals

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:  # noqa: D102
        before, (after,) = self.parts[0].vertices, moved
        types = {self.ply["vertex"].ply_property(name).val_dtype for name in _AXES}
        told = rounding_told(before, after) if "f4" in types else None
        with target.open("wb") as file:
            if (after != before).any():
                self._write(file, after, bool(told))
            else:
                file.write(self.content)
        textures = map(os.fsdecode, _TEXTURE.findall(self.header))
        return widening_warnings(told) + copy_side_files(self.path, target, textures)

    def _write(self, file: IO[bytes], after: Array, is_wide: bool) -> None:
        (part,), rows, start = self.parts, self.rows, len(self.header)
        changes = {_AXES: (part.vertices, after)}
        if self.normals is not None:
            normals = following_normals(part.vertices, after, part.faces, self.normals)
            changes[_NORMALS] = self.normals, normals
        file.write(_widened(self.header) if is_wide else self.header)
        if isinstance(rows, Lines):
            digits = digits_for(part.vertices, after)
            words = [(rows.starts, self.first[a], *pair, digits) for a, pair in changes.items()]
            write_patched(file, self.content, words, start)
        else:
            content = memoryview(self.content)
            new = _with_columns(rows, changes, self.ply.byte_order if is_wide else None)
            file.writelines([content[start : self.span.start], new, content[self.span.stop :]])


def _with_columns(rows: _Rows, changes: _Changes, wide: str | None) -> memoryview:
    """Return binary rows with new numbers; `wide` is the byte order of doubles, if needed."""
    fields = [
        (name, f"{wide}f8" if wide and name in _AXES else type_, *shape)
        for name, type_, *shape in rows.dtype.descr
    ]
    rows = rows.astype(fields)
    for names, (_, after) in changes.items():
        for name, column in zip(names, after.T, strict=True):
            rows[name] = column
    return rows.view(np.uint8).data


def _widened(header: bytes) -> bytes:
    """Return the header with coordinates declared as double."""
    vertex = re.compile(rb"(?ms)^[ \t]*element\s+vertex\s.*?^[ \t]*e")  # next element or end
    axis = re.compile(rb"(?m)^([ \t]*property[ \t]+)\S+(?=[ \t]+[xyz]\s*$)")
    return vertex.sub(lambda found: axis.sub(rb"\1double", found[0]), header)


def read(path: Path) -> PlyDocument:
    """Read a PLY file; raises MeshFileError when it is damaged or its layout is not supported."""
    content = path.read_bytes()
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")  # about empty lists and non-integers
            ply, counts, header = _read_header(content)
            tables, span = _read_rows(content, ply, counts, len(header))
            vertex = tables["vertex"]
            rows = _checked_rows(path, ply, vertex)
            vertices = _columns(vertex, *_AXES)
            check_vertices(path, vertices)
            faces = _read_faces(tables, vertices)
    except (PlyParseError, ValueError, LookupError, TypeError, OverflowError) as error:
        raise unreadable(path, error) from error
    check_indices(path, faces, len(vertices))
    values = [name for name in ("quality", "confidence") if _has_floats(ply["vertex"], name)]
    quality = _columns(vertex, values[0])[:, 0] if values else None
    has_normals = _has_floats(ply["vertex"], *_NORMALS)
    return PlyDocument(
        path,
        [Part("", vertices, faces, quality, _selected(tables, len(vertices)))],
        _contents(ply, counts, header, len(faces)),
        content=content,
        header=header,
        ply=ply,
        rows=rows,
        span=span,
        normals=_columns(vertex, *_NORMALS) if has_normals else None,
        first={_AXES: _first_word(vertex, "x"), _NORMALS: _first_word(vertex, "nx")},
    )


def _read_header(content: bytes) -> tuple[PlyData, dict[str, int], bytes]:
    """Read the header with plyfile, without comments (it accepts only ASCII), with counts of 0."""
    end = re.search(rb"(?s)\n[ \t]*element\s+vertex\s.*?\n[ \t]*end_header[ \t]*\r?\n", content)
    if not end:
        raise ValueError("it has no PLY header with vertices")
    header = content[: end.end()]
    lines = b"".join(line.strip() + b"\n" for line in header.splitlines())
    lines = re.sub(rb"(?m)^(comment|obj_info)\b.*", b"comment", lines)
    counts = [int(word) for word in re.findall(rb"(?m)^element\s+\S+\s+(\S+)", lines)]
    empty = re.sub(rb"(?m)^(element\s+\S+)\s+\S+", rb"\1 0", lines)
    ply = PlyData.read(io.BytesIO(empty))
    return ply, dict(zip([one.name for one in ply], counts, strict=True)), header


def _read_rows(
    content: bytes, ply: PlyData, counts: dict[str, int], start: int
) -> tuple[dict[str, _Table], slice]:
    """Read the rows of all elements, and return the byte range of binary vertices, too."""
    tables, span = dict[str, _Table](), slice(0)
    if any(not 0 <= count <= len(content) for count in counts.values()):
        raise ValueError(f"it cannot have the numbers of rows {list(counts.values())}")
    lines = lines_of(content, begin=start, limit=sum(counts.values()) if ply.text else 0)
    for element in ply:
        count = counts[element.name]
        if ply.text:
            table = _text_rows(element, count, lines[:count], ply)
            lines = lines[count:]
        else:
            table = _binary_rows(element, count, content, start, ply)
        tables[element.name] = table
        span = slice(start, start + table.size) if element.name == "vertex" else span
        start += table.size
    return tables, span


def _text_rows(element: PlyElement, count: int, lines: Lines, ply: PlyData) -> _Table:
    are_lists = [isinstance(one, PlyListProperty) for one in element.properties]
    numbers, lists, bad = lines.table(are_lists, is_whole=True)
    if bad >= 0:
        raise _fault(element, bad, lines, ply)
    if len(lines) < count:
        raise ValueError(f"element {element.name!r}: row {len(lines)}: early end-of-file")
    single, several, names = _names(element)
    columns, found = zip(single, numbers.T, strict=True), zip(several, lists, strict=True)
    return _Table(names, dict(columns), dict(found), rows=lines)


def _fault(element: PlyElement, row: int, lines: Lines, ply: PlyData) -> ValueError:
    """Return what plyfile says about a row."""
    try:
        _with_plyfile(element, 1, b" ".join(lines.words_of(row)), ply)
    except PlyElementParseError as error:
        told = PlyElementParseError(error.message, error.element, row, error.prop)
        return ValueError(str(told))
    return ValueError(f"element {element.name!r}: row {row}: malformed input")


def _names(element: PlyElement) -> tuple[list[str], list[str], list[str]]:
    """Return the names of the properties that are numbers, of those that are lists, and all."""
    several = [one.name for one in element.properties if isinstance(one, PlyListProperty)]
    names = [one.name for one in element.properties]
    return [name for name in names if name not in several], several, names


def _binary_rows(
    element: PlyElement, count: int, content: bytes, start: int, ply: PlyData
) -> _Table:
    single, several, names = _names(element)
    lists: dict[str, tuple[Indices, NDArray[Any]]]
    rows = _even_rows(element, count, content, start, ply.byte_order)
    if rows is not None:
        lists = {
            name: (np.full(count, rows[name].shape[1]), rows[name].reshape(-1)) for name in several
        }
        return _Table(names, {name: rows[name] for name in single}, lists, rows.nbytes, rows)
    uneven, size = _with_plyfile(element, count, content[start:], ply)
    sizes = {name: np.array(list(map(len, uneven[name])), np.int64) for name in several}
    lists = {name: (sizes[name], np.concatenate(uneven[name])) for name in several}
    return _Table(names, {name: uneven[name] for name in single}, lists, size)


def _even_rows(
    element: PlyElement, count: int, content: bytes, start: int, order: str
) -> _Rows | None:
    """Return the rows if their lists fit triangles alone, or quadrilaterals alone; else None."""
    for corners in (3, 4):
        fields = list[Any]()
        for one in element.properties:
            shape: tuple[int, ...] = ()
            if isinstance(one, PlyListProperty):
                shape = (2 * corners if one.name == "texcoord" else corners,)
                fields.append((f"{one.name}\n", order + one.len_dtype))
            fields.append((one.name, order + one.val_dtype, shape))
        with suppress(ValueError, TypeError):  # too few bytes
            rows = np.ndarray(count, np.dtype(fields), content, start)
            if all((rows[f"{name}\n"] == rows[name].shape[1]).all() for name in _names(element)[1]):
                return rows
    return None


def _with_plyfile(element: PlyElement, count: int, body: bytes, ply: PlyData) -> tuple[_Rows, int]:
    """Return rows with lists of any length, slowly, and their size in bytes."""
    format_, own = ply.header.split("\n")[1], element.header.replace(" 0\n", f" {count}\n", 1)
    stream = io.BytesIO(f"ply\n{format_}\n{own}\nend_header\n".encode() + body)
    rows = PlyData.read(stream)[element.name].data
    return rows, len(body) - len(stream.read())


def _first_word(table: _Table, name: str) -> int:
    """Return how many words text rows have before a number; their lists have the same size."""
    before = table.names[: table.names.index(name)] if name in table.names else []
    sizes = [table.lists[one][0][:1].sum() for one in before if one in table.lists]
    return len(before) + int(sum(sizes))


def _checked_rows(path: Path, ply: PlyData, table: _Table) -> Lines | _Rows:
    names = " ".join(["", *table.names, ""])
    is_apart = " x y z " not in names or (" nx " in names and " nx ny nz " not in names)
    is_uneven = any((sizes != sizes[0]).any() for sizes, _ in table.lists.values() if len(sizes))
    if (
        table.rows is None
        or is_uneven
        or (ply.text and is_apart)
        or not _has_floats(ply["vertex"], *_AXES)
    ):
        what = "has vertices with lists of several lengths, or without floats x, y, z side by side"
        raise unsupported(path, what, "open it in MeshLab and export it as .ply")
    return table.rows


def _has_floats(element: PlyElement, *names: str) -> bool:
    return all(name in element and element.ply_property(name).dtype()[1] == "f" for name in names)


def _columns(table: _Table, *names: str) -> Array:
    return np.column_stack([table.columns[name] for name in names]).astype(np.float64, copy=False)


def _corners(table: _Table | None) -> tuple[Indices, Indices] | None:
    """Return the corners of all faces or strips, and how many each has; None if there are none."""
    lists = [table.lists[name] for name in _CORNERS if name in table.lists] if table else []
    return (lists[0][1].astype(np.int64), lists[0][0]) if lists and len(lists[0][0]) else None


def _read_faces(tables: dict[str, _Table], vertices: Array) -> Indices:
    if faces := _corners(tables.get("face")):
        return triangles(*faces, vertices)
    if strips := _corners(tables.get("tristrips")):
        return strip_triangles(np.insert(strips[0], np.cumsum(strips[1]), -1))
    return np.zeros((0, 3), np.int64)


def _selected(tables: dict[str, _Table], count: int) -> NDArray[np.bool_] | None:
    """Return which vertices MeshLab's flags select, directly or by a face; None if none."""
    chosen = np.zeros(count, bool)
    if "flags" in tables["vertex"].columns:
        chosen |= tables["vertex"].columns["flags"].astype(np.int64) & _SELECTED > 0
    faces = _corners(tables.get("face"))
    if faces and "flags" in tables["face"].columns:
        flags = tables["face"].columns["flags"].astype(np.int64) & _SELECTED > 0
        chosen[faces[0][np.repeat(flags, faces[1])]] = True
    return chosen if chosen.any() else None


def _contents(ply: PlyData, counts: dict[str, int], header: bytes, triangles: int) -> list[str]:
    mesh = [element for element in ply if element.name in ("vertex", "face", "tristrips")]
    names = {one.name for element in mesh for one in element.properties}
    others = names.difference(_AXES, _CORNERS, *_KNOWN.values())
    present: dict[str, object] = {word: names & known for word, known in _KNOWN.items()}
    present["polygons"] = counts.get("face", triangles) < triangles
    present["comments"], present["texture names"] = _COMMENT.search(header), _TEXTURE.search(header)
    present.update((f"property {name}", True) for name in sorted(others))
    present.update((f"element {one.name}", counts[one.name]) for one in ply if one not in mesh)
    return [word for word, is_there in present.items() if is_there]
