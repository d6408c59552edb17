"""PLY files: vertex coordinates and normals are replaced, all other bytes are kept."""

from __future__ import annotations

import io
import os
import re
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyListProperty, PlyParseError

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
from meshlab_spectral.documents.text import with_numbers

_AXES, _NORMALS = ("x", "y", "z"), ("nx", "ny", "nz")
_LINE = re.compile(rb"\s*\S[^\n]*\n?")  # a line, with the empty ones before it
_PLAIN = bytes.maketrans(b"\r\x1c\x1d\x1e\x1f\x85\xa0", b" ??????")  # blanks in str, not in bytes
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


@dataclass(kw_only=True)
class PlyDocument(Document):
    """A PLY file with its bytes; `span` is the byte range of the vertices."""

    content: bytes
    header: bytes
    ply: PlyData
    span: slice

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:  # noqa: D102
        before, (after,) = self.parts[0].vertices, moved
        types = {self.ply["vertex"].ply_property(name).val_dtype for name in _AXES}
        told = rounding_told(before, after) if "f4" in types else None
        content = self._moved(after, bool(told)) if (after != before).any() else self.content
        target.write_bytes(content)
        textures = map(os.fsdecode, _TEXTURE.findall(self.header))
        return widening_warnings(told) + copy_side_files(self.path, target, textures)

    def _moved(self, after: Array, is_wide: bool) -> bytes:
        part, vertex = self.parts[0], self.ply["vertex"]
        changes: _Changes = {_AXES: (part.vertices, after)}
        if _has_floats(vertex, *_NORMALS):
            old = _columns(vertex, *_NORMALS)
            changes[_NORMALS] = old, following_normals(part.vertices, after, part.faces, old)
        if self.ply.text:
            rows = _with_words(self.content[self.span], vertex.data.dtype, changes)
        else:
            rows = _with_columns(vertex.data, changes, self.ply.byte_order if is_wide else None)
        header = _widened(self.header) if is_wide else self.header
        between = self.content[len(self.header) : self.span.start]
        return header + between + rows + self.content[self.span.stop :]


def _with_words(rows: bytes, type_: Any, changes: _Changes) -> bytes:
    """Return text rows with the changed numbers replaced."""
    lines, digits = _LINE.findall(rows), digits_for(*changes[_AXES])
    for names, (before, after) in changes.items():
        first = type_.fields[names[0]][1] // 8
        for i in np.flatnonzero((before != after).any(axis=1)).tolist():
            lines[i] = with_numbers(lines[i], first, before[i].tolist(), after[i].tolist(), digits)
    return b"".join(lines)


def _with_columns(rows: _Rows, changes: _Changes, wide: str | None) -> bytes:
    """Return binary rows with new numbers; `wide` is the byte order of doubles, if needed."""
    fields = [
        (name, f"{wide}f8" if wide and name in _AXES else type_, *shape)
        for name, type_, *shape in rows.dtype.descr
    ]
    rows = rows.astype(fields)
    for names, (_, after) in changes.items():
        for name, column in zip(names, after.T, strict=True):
            rows[name] = column
    return rows.tobytes()


def _widened(header: bytes) -> bytes:
    """Return the header with coordinates declared as double."""
    vertex = re.compile(rb"(?ms)^[ \t]*element\s+vertex\s.*?^[ \t]*e")  # next element or end
    axis = re.compile(rb"(?m)^([ \t]*property[ \t]+)\S+(?=[ \t]+[xyz]\s*$)")
    return vertex.sub(lambda found: axis.sub(rb"\1double", found[0]), header)


def read(path: Path) -> PlyDocument:
    """Read a PLY file; raises MeshFileError when it is damaged or its layout is not supported."""
    content = path.read_bytes()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about empty lists and non-integers
            ply, counts, header = _read_header(content)
            span = _read_rows(content, ply, counts, len(header))
            _check_vertices(path, ply)
            vertices = _columns(ply["vertex"], *_AXES)
            check_vertices(path, vertices)
            faces = _read_faces(ply, vertices)
    except (PlyParseError, ValueError, LookupError, TypeError, OverflowError) as error:
        raise unreadable(path, error) from error
    check_indices(path, faces, len(vertices))
    values = [name for name in ("quality", "confidence") if _has_floats(ply["vertex"], name)]
    quality = _columns(ply["vertex"], values[0])[:, 0] if values else None
    part = Part("", vertices, faces, quality, _selected(ply))
    held = _contents(ply, header, len(faces))
    return PlyDocument(path, [part], held, content=content, header=header, ply=ply, span=span)


def _read_header(content: bytes) -> tuple[PlyData, list[int], bytes]:
    """Read the header with plyfile, without comments (it accepts only ASCII), with counts of 0."""
    end = re.search(rb"(?s)\n[ \t]*element\s+vertex\s.*?\n[ \t]*end_header[ \t]*\r?\n", content)
    if not end:
        raise ValueError("it has no PLY header with vertices")
    header = content[: end.end()]
    lines = b"".join(line.strip() + b"\n" for line in header.splitlines())
    lines = re.sub(rb"(?m)^(comment|obj_info)\b.*", b"comment", lines)
    counts = [int(word) for word in re.findall(rb"(?m)^element\s+\S+\s+(\S+)", lines)]
    empty = re.sub(rb"(?m)^(element\s+\S+)\s+\S+", rb"\1 0", lines)
    return PlyData.read(io.BytesIO(empty)), counts, header


def _read_rows(content: bytes, ply: PlyData, counts: list[int], start: int) -> slice:
    """Read the rows of all elements, and return the byte range of the vertices."""
    read_rows, span = _text_rows if ply.text else _binary_rows, slice(0)
    for element, count in zip(ply, counts, strict=True):
        body = content[start:]
        if not 0 <= count <= len(body):
            raise ValueError(f"element {element.name!r} cannot have {count} rows")
        element.data, size = read_rows(element, count, body, ply)  # size in bytes
        span = slice(start, start + size) if element.name == "vertex" else span
        start += size
    return span


def _text_rows(element: PlyElement, count: int, body: bytes, ply: PlyData) -> tuple[_Rows, int]:
    lines = _LINE.findall(body.translate(_PLAIN))[:count]
    words = list(map(bytes.strip, lines))
    rows = _even_rows(element, "f8", lambda row: np.loadtxt(words, row, None).reshape(count))
    if rows is None:
        rows, _ = _uneven_rows(element, count, b"\n".join(words), ply)
    return rows, sum(map(len, lines))


def _binary_rows(element: PlyElement, count: int, body: bytes, ply: PlyData) -> tuple[_Rows, int]:
    rows = _even_rows(element, ply.byte_order + "{}", lambda row: np.ndarray(count, row, body))
    return _uneven_rows(element, count, body, ply) if rows is None else (rows, rows.nbytes)


def _even_rows(element: PlyElement, form: str, parse: Callable[[Any], _Rows]) -> _Rows | None:
    """Return the rows if their lists fit triangles alone, or quadrilaterals alone; else None."""
    for corners in (3, 4):
        fields = list[Any]()
        for one in element.properties:
            shape: tuple[int, ...] = ()
            if isinstance(one, PlyListProperty):
                shape = (2 * corners if one.name == "texcoord" else corners,)
                fields.append((f"{one.name}\n", form.format(one.len_dtype)))
            fields.append((one.name, form.format(one.val_dtype), shape))
        with suppress(ValueError, TypeError):  # too few columns or bytes
            rows = parse(np.dtype(fields))
            lists = [one.name for one in element.properties if isinstance(one, PlyListProperty)]
            if all((rows[f"{name}\n"] == rows[name].shape[1]).all() for name in lists):
                return rows
    return None


def _uneven_rows(element: PlyElement, count: int, body: bytes, ply: PlyData) -> tuple[_Rows, int]:
    """Return rows with lists of any length, slowly, and their size in bytes, 0 for text."""
    format_, own = ply.header.split("\n")[1], element.header.replace(" 0\n", f" {count}\n", 1)
    stream = io.BytesIO(f"ply\n{format_}\n{own}\nend_header\n".encode() + body)
    rows = PlyData.read(stream)[element.name].data
    return rows, 0 if ply.text else len(body) - len(stream.read())


def _check_vertices(path: Path, ply: PlyData) -> None:
    vertex = ply["vertex"]
    names = " ".join(["", *(one.name for one in vertex.properties), ""])
    is_apart = " x y z " not in names or (" nx " in names and " nx ny nz " not in names)
    if not _has_floats(vertex, *_AXES) or vertex.data.dtype.hasobject or (ply.text and is_apart):
        what = "has vertices with lists of several lengths, or without floats x, y, z side by side"
        raise unsupported(path, what, "open it in MeshLab and export it as .ply")


def _has_floats(element: PlyElement, *names: str) -> bool:
    return all(name in element and element.ply_property(name).dtype()[1] == "f" for name in names)


def _columns(element: PlyElement, *names: str) -> Array:
    return np.column_stack([element[name] for name in names]).astype(np.float64)


def _read_faces(ply: PlyData, vertices: Array) -> Indices:
    for name in ("face", "tristrips"):
        held = [one for one in _CORNERS if name in ply and one in ply[name]]
        if held and ply[name].count:
            lists = ply[name][held[0]]
            sizes = np.array([len(one) for one in lists])
            corners = np.concatenate(lists).astype(np.int64)
            if name == "face":
                return triangles(corners, sizes, vertices)
            return strip_triangles(np.insert(corners, np.cumsum(sizes), -1))
    return np.zeros((0, 3), np.int64)


def _selected(ply: PlyData) -> NDArray[np.bool_] | None:
    """Return which vertices MeshLab's flags select, directly or by a face; None if none."""
    chosen = np.zeros(ply["vertex"].count, bool)
    if "flags" in ply["vertex"]:
        chosen |= ply["vertex"]["flags"].astype(np.int64) & _SELECTED > 0
    if "face" in ply and "flags" in ply["face"]:
        held = [one for one in _CORNERS if one in ply["face"]]
        flags = ply["face"]["flags"].astype(np.int64)
        for face in np.flatnonzero(flags & _SELECTED) if held else ():
            chosen[ply["face"][held[0]][face]] = True
    return chosen if chosen.any() else None


def _contents(ply: PlyData, header: bytes, triangles: int) -> list[str]:
    mesh = [element for element in ply if element.name in ("vertex", "face", "tristrips")]
    names = {one.name for element in mesh for one in element.properties}
    others = names.difference(_AXES, _CORNERS, *_KNOWN.values())
    present: dict[str, object] = {word: names & known for word, known in _KNOWN.items()}
    present["polygons"] = "face" in ply and ply["face"].count < triangles
    present["comments"], present["texture names"] = _COMMENT.search(header), _TEXTURE.search(header)
    present.update((f"property {name}", True) for name in sorted(others))
    present.update((f"element {one.name}", one.count) for one in ply if one not in mesh)
    return [word for word, is_there in present.items() if is_there]
