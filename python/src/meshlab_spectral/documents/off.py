"""OFF files: the numbers in the lines of vertices are replaced."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np

from meshlab_spectral.documents.digits import SINGLE, digits_for
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
from meshlab_spectral.documents.polygons import triangles
from meshlab_spectral.documents.text import Words, numbers, replace_numbers

_REMEDY = "save it as PLY, or as text OFF with one vertex x y z per line"


@dataclass(kw_only=True)
class _Off(Document):
    lines: list[bytes]
    where: list[int]  # the line of each vertex
    normals: Array | None

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        before, after, lines = self.parts[0].vertices, moved[0], self.lines.copy()
        replace_numbers(lines, self.where, 0, before, after, digits_for(before, after))
        if self.normals is not None:
            normals = following_normals(before, after, self.parts[0].faces, self.normals)
            replace_numbers(lines, self.where, 3, self.normals, normals, SINGLE)
        target.write_bytes(b"".join(lines))
        return []


def read(path: Path) -> Document:
    """Read a text OFF file; raise MeshFileError when it is damaged or of another kind."""
    try:
        return _document(path, path.read_bytes().splitlines(keepends=True))
    except (ValueError, IndexError, OverflowError) as error:
        raise unreadable(path, error) from error


def _document(path: Path, lines: list[bytes]) -> Document:
    where = [number for number, line in enumerate(lines) if line.partition(b"#")[0].strip()]
    rows = [tuple(lines[number].partition(b"#")[0].split()) for number in where]
    header = _header(path, rows)
    counts, begin = (rows[0][1:], 1) if len(rows[0]) > 1 else (rows[1], 2)
    middle = begin + int(counts[0])
    end = middle + int(counts[1])
    _check_bounds(path, rows, begin, middle, end)
    V = numbers(path, rows[begin:middle])
    check_vertices(path, V)
    corners, sizes = _polygons(rows[middle:end])
    part = Part("", V, triangles(corners, sizes, V))
    check_indices(path, part.faces, len(V))
    held = {
        "normals": b"N" in header,
        "colours": b"C" in header,
        "texture coordinates": b"ST" in header,
        "face colours": any(len(row) > int(row[0]) + 1 for row in rows[middle:end]),
        "polygons": (sizes > 3).any(),
        "comments": any(b"#" in line for line in lines),
    }
    normals = numbers(path, rows[begin:middle], 3) if held["normals"] else None
    contents = [name for name in held if held[name]]
    return _Off(path, [part], contents, lines=lines, where=where[begin:middle], normals=normals)


def _header(path: Path, rows: Sequence[Words]) -> bytes:
    header = rows[0][0] if rows else b""
    if not header.endswith(b"OFF"):
        raise unreadable(path, "its first word is not OFF, COFF, NOFF or the like")
    if b"4" in header or b"n" in header or b"BINARY" in rows[0]:
        raise unsupported(path, "is binary, or has vertices other than x y z", _REMEDY)
    return header


def _check_bounds(path: Path, rows: Sequence[Words], begin: int, middle: int, end: int) -> None:
    """Raise MeshFileError unless there is a row for each vertex and each face."""
    if begin < middle <= end <= len(rows):
        return
    vertices, faces, left = middle - begin, end - middle, len(rows) - begin
    if 0 < 3 * vertices + faces <= sum(map(len, rows[begin:])):
        raise unsupported(path, "does not have one line per vertex and face", _REMEDY)
    raise ValueError(f"it claims {vertices} vertices and {faces} faces, in {left} lines")


def _polygons(rows: Sequence[Words]) -> tuple[Indices, Indices]:
    """Return the corners of all faces, and the number of corners of each."""
    sizes = [int(row[0]) for row in rows]
    chosen = [row[1 : size + 1] for row, size in zip(rows, sizes, strict=True)]
    if list(map(len, chosen)) != sizes:
        raise ValueError("a face has fewer corners than it claims")
    corners = list(map(int, chain.from_iterable(chosen)))
    return np.array(corners, dtype=np.int64), np.array(sizes, dtype=np.int64)
