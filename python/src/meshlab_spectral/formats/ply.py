"""PLY files: vertex coordinates and normals are replaced, all other bytes are kept."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyListProperty, PlyParseError

from meshlab_spectral.formats.causes import unreadable, unsupported
from meshlab_spectral.formats.digits import digits_for, rounding_loss, widening_warnings
from meshlab_spectral.formats.document import (
    Array,
    Document,
    Indices,
    Part,
    check_indices,
    check_vertices,
)
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.normals import following_normals
from meshlab_spectral.formats.ply_elements import Table, read_elements, read_header, row_type
from meshlab_spectral.formats.polygons import strip_triangles, triangles
from meshlab_spectral.formats.rows import Rows
from meshlab_spectral.formats.side_files import copy_side_files
from meshlab_spectral.formats.text import as_integers, write_patched
from meshlab_spectral.warned import Warned

AXES, NORMALS = ("x", "y", "z"), ("nx", "ny", "nz")
_TEXTURE = re.compile(rb"(?m)^[ \t]*comment[ \t]+TextureFile[ \t]+(\S.*)")
_COMMENT = re.compile(rb"(?m)^[ \t]*(comment|obj_info)[ \t]+(?!TextureFile|VCGLIB generated)\S")
CORNERS = ("vertex_indices", "vertex_index")
_KNOWN = {
    "normals": set(NORMALS),
    "colours": {"red", "green", "blue", "alpha", "diffuse_red", "diffuse_green", "diffuse_blue"},
    "texture coordinates": {"s", "t", "u", "v", "texture_u", "texture_v", "texcoord", "texnumber"},
    "quality": {"quality"},
}
_SELECTED = 0x20  # VCG's flag
_Changes = dict[tuple[str, ...], tuple[Array, Array]]  # before and after
Columns = dict[tuple[str, ...], tuple[Indices | slice, Array]]  # in which rows, and what


@dataclass(kw_only=True)
class PlyDocument(Document):
    """A PLY file with its bytes."""

    content: bytes
    header: bytes
    ply: PlyData
    rows: Indices | Rows  # of the vertices: byte offsets of text lines, or binary rows
    begin: int  # byte offset of binary rows
    normals: Array | None
    first: dict[tuple[str, ...], int]  # text: the words before coordinates, and before normals
    places: dict[str, Indices] | None = None  # of binary numbers whose rows differ in length

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:  # noqa: D102
        before, (after,) = self.parts[0].vertices, moved
        types = {self.ply["vertex"].ply_property(name).val_dtype for name in AXES}
        loss = rounding_loss(before, after) if "f4" in types else None
        if any(type_[0] != "f" for type_ in types):
            loss = "the file has integers"
        with target.open("wb") as file:
            self._write(file, after, bool(loss))
        return widening_warnings(loss) + copy_side_files(self.path, target, self.side_files())

    def side_files(self) -> list[str]:  # noqa: D102
        return [os.fsdecode(name.rstrip()) for name in _TEXTURE.findall(self.header)]

    def _write(self, file: IO[bytes], after: Array, is_wide: bool) -> None:
        (part,), rows, start = self.parts, self.rows, len(self.header)
        changes: _Changes = {AXES: (part.vertices, after)}
        if self.normals is not None:
            normals = following_normals(part.vertices, after, part.faces, self.normals)
            changes[NORMALS] = self.normals, normals
        file.write(widened(self.header) if is_wide else self.header)
        if self.ply.text:
            digits = digits_for(part.vertices, after)
            words = [(rows, self.first[a], *pair, digits) for a, pair in changes.items()]
            write_patched(file, self.content, words, start)
        elif self.places is not None:
            file.write(self._patched(changes, self.places, is_wide)[start:].data)
        else:
            content, end = memoryview(self.content), self.begin + rows.nbytes
            columns: Columns = {a: (slice(None), new) for a, (_, new) in changes.items()}
            moved = with_columns(rows, columns, self.ply.byte_order if is_wide else None)
            bytes_ = moved.view(np.uint8).data
            file.writelines([content[start : self.begin], bytes_, content[end:]])

    def _patched(
        self, changes: _Changes, places: dict[str, Indices], is_wide: bool
    ) -> NDArray[np.uint8]:
        """Return the bytes of the file with new numbers in rows of several lengths."""
        vertex, content = self.ply["vertex"], np.frombuffer(self.content, np.uint8).copy()
        types = {name: vertex.ply_property(name).val_dtype for name in places}
        if is_wide:
            lacking = np.repeat(
                [8 - np.dtype(types[name]).itemsize for name in AXES], len(places["x"])
            )
            at = np.concatenate([places[name] for name in AXES])
            order = np.argsort(at)
            at, lacking = at[order], lacking[order]
            content = np.insert(content, np.repeat(at, lacking), 0)
            added = np.append(0, np.cumsum(lacking))
            places = {name: one + added[np.searchsorted(at, one)] for name, one in places.items()}
            types |= dict.fromkeys(AXES, "f8")
        for names, (_, after) in changes.items():
            for name, column in zip(names, after.T, strict=True):
                new = np.ascontiguousarray(column, self.ply.byte_order + types[name])
                bytes_ = places[name][:, None] + np.arange(new.itemsize)
                content[bytes_] = new.view(np.uint8).reshape(len(new), -1)
        return content


def with_columns(rows: Rows, columns: Columns, wide: str | None) -> Rows:
    """Return binary rows with new numbers; `wide` is the byte order of doubles, if needed."""
    fields = [
        (name, f"{wide}f8" if wide and name in AXES else type_, *shape)
        for name, type_, *shape in rows.dtype.descr
    ]
    rows = rows.astype(fields)
    for names, (where, table) in columns.items():
        for name, column in zip(names, table.T, strict=True):
            rows[name][where] = column
    return rows


def widened(header: bytes) -> bytes:
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
            ply, counts, header = read_header(content)
            tables, rows, begin = read_elements(content, ply, counts, len(header))
            vertex = tables["vertex"]
            _check_vertices(path, ply, vertex)
            vertices = _columns(vertex, *AXES)
            check_vertices(path, vertices)
            faces = _read_faces(tables, vertices)
    except (PlyParseError, ValueError, LookupError, TypeError, OverflowError) as error:
        raise unreadable(path, error) from error
    check_indices(path, faces, len(vertices))
    value = quality_of(ply["vertex"])
    quality = vertex[value].copy() if value else None
    has_normals = has_floats(ply["vertex"], *NORMALS)
    is_uneven, sizes = not ply.text and _is_uneven(vertex), _sizes(vertex)
    return PlyDocument(
        path,
        [Part("", vertices, faces, quality, _selected(tables, len(vertices)))],
        _contents(ply, counts, header, len(faces)),
        content=content,
        header=header,
        ply=ply,
        rows=rows
        if ply.text or is_uneven
        else np.ndarray(
            len(vertices),
            row_type(ply["vertex"], ply.byte_order, lambda fields: sizes[fields[-1][0][:-1]]),
            content,
            begin,
        ),
        places=_places(ply, vertex, begin) if is_uneven else None,
        begin=begin,
        normals=_columns(vertex, *NORMALS) if has_normals else None,
        largest_face=int(corners[1].max()) if (corners := _corners(tables.get("face", {}))) else 3,
        first={AXES: _first_word(vertex, "x"), NORMALS: _first_word(vertex, "nx")},
    )


def _sizes(table: Table) -> dict[str, int]:
    """Return how many items the lists of each property have in the first row, at least."""
    lists = {name: one[0] for name, one in table.items() if isinstance(one, tuple)}
    return {name: int(sizes[0]) if len(sizes) else 0 for name, sizes in lists.items()}


def _first_word(table: Table, name: str) -> int:
    """Return how many words text rows have before a number; their lists have the same size."""
    before = list(table)[: list(table).index(name)] if name in table else []
    return len(before) + sum(_sizes(table).get(one, 0) for one in before)


def _check_vertices(path: Path, ply: PlyData, table: Table) -> None:
    names = " ".join(["", *table, ""])
    is_apart = " x y z " not in names or (" nx " in names and " nx ny nz " not in names)
    if (ply.text and (is_apart or _is_uneven(table, before="x"))) or not _has_numbers(
        ply["vertex"]
    ):
        what = "has vertices without x, y, z side by side, or with uneven lists before them"
        raise unsupported(path, what, "export it again with x, y and z as the first properties")


def _is_uneven(table: Table, before: str | None = None) -> bool:
    """Whether lists have several lengths, of those before the last of coordinates and normals."""
    names = list(table)
    if before is not None:
        names = names[: max(names.index(name) for name in (before, "nx") if name in names)]
    sizes = {name: table[name][0] for name in names if isinstance(table[name], tuple)}
    return any((one != one[0]).any() for one in sizes.values() if len(one))


def _places(ply: PlyData, table: Table, begin: int) -> dict[str, Indices]:
    """Return the byte offsets of the numbers of binary vertices."""
    within, places = np.zeros(len(table["x"]), np.int64), dict[str, Indices]()
    for one in ply["vertex"].properties:
        size = np.dtype(one.val_dtype).itemsize
        places[one.name] = within.copy()
        if isinstance(one, PlyListProperty):
            within += np.dtype(one.len_dtype).itemsize + size * table[one.name][0].astype(np.int64)
        else:
            within += size
    starts = begin + np.cumsum(within) - within
    return {name: starts + offset for name, offset in places.items()}


def has_floats(element: PlyElement, *names: str) -> bool:
    """Whether an element has these properties, as floating-point numbers."""
    return all(name in element and element.ply_property(name).dtype()[1] == "f" for name in names)


def quality_of(element: PlyElement) -> str:
    """Return the name of the quality, as MeshLab calls it, or scanners; "" if there is none."""
    return next((name for name in ("quality", "confidence") if has_floats(element, name)), "")


def _has_numbers(element: PlyElement) -> bool:
    axes = [element.ply_property(name) for name in AXES if name in element]
    return len(axes) == 3 and not any(isinstance(one, PlyListProperty) for one in axes)


def _columns(table: Table, *names: str) -> Array:
    return np.column_stack([table[name] for name in names])


def _corners(table: Table) -> tuple[Indices, Indices] | None:
    """Return the corners of all faces or strips, and how many each has; None if there are none."""
    found = [table[name] for name in CORNERS if name in table]
    return (as_integers(found[0][1]), found[0][0]) if found and len(found[0][0]) else None


def _read_faces(tables: dict[str, Table], vertices: Array) -> Indices:
    if faces := _corners(tables.get("face", {})):
        return triangles(*faces, vertices)
    if strips := _corners(tables.get("tristrips", {})):
        return strip_triangles(np.insert(strips[0], np.cumsum(strips[1]), -1))
    return np.zeros((0, 3), np.int64)


def _selected(tables: dict[str, Table], count: int) -> NDArray[np.bool_] | None:
    """Return which vertices MeshLab's flags select, directly or by a face; None if none."""
    chosen = np.zeros(count, bool)
    if "flags" in tables["vertex"]:
        chosen |= is_selected(tables["vertex"]["flags"])
    face = tables.get("face", {})
    if "flags" in face and (faces := _corners(face)):
        flags = is_selected(face["flags"])
        chosen[faces[0][np.repeat(flags, faces[1])]] = True
    return chosen if chosen.any() else None


def is_selected(flags: Any) -> NDArray[np.bool_]:
    """Whether flags of MeshLab say so, for each of them."""
    return np.asarray(flags.astype(np.int64) & _SELECTED > 0)


def _contents(ply: PlyData, counts: dict[str, int], header: bytes, triangles: int) -> list[str]:
    mesh = [element for element in ply if element.name in ("vertex", "face", "tristrips")]
    names = {one.name for element in mesh for one in element.properties}
    others = names.difference(AXES, CORNERS, *_KNOWN.values())
    present: dict[str, object] = {word: names & known for word, known in _KNOWN.items()}
    colours = {one.name: _KNOWN["colours"] & {p.name for p in one.properties} for one in mesh}
    present["colours"] = colours.pop("vertex")
    present["face colours"] = any(colours.values())
    present["polygons"] = counts.get("face", triangles) < triangles
    present["comments"], present["texture names"] = _COMMENT.search(header), _TEXTURE.search(header)
    present.update((f"property {shown(name)}", True) for name in sorted(others))
    present.update(
        (f"element {shown(one.name)}", counts[one.name]) for one in ply if one not in mesh
    )
    return [word for word, is_there in present.items() if is_there]
