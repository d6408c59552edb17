"""OFF files: the numbers in the lines of vertices are replaced."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

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
from meshlab_spectral.documents.text import Lines, lines_of, whole, write_patched

_REMEDY = "save it as PLY, or as text OFF with one vertex x y z per line"


@dataclass(kw_only=True)
class _Off(Document):
    content: bytes
    starts: Indices  # byte offsets of the vertices
    normals: Array | None

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        before, after = self.parts[0].vertices, moved[0]
        changes = [(self.starts, 0, before, after, digits_for(before, after))]
        if self.normals is not None:
            normals = following_normals(before, after, self.parts[0].faces, self.normals)
            changes.append((self.starts, 3, self.normals, normals, SINGLE))
        with target.open("wb") as file:
            write_patched(file, self.content, changes)
        return []


def read(path: Path) -> Document:
    """Read a text OFF file; raise MeshFileError when it is damaged or of another kind."""
    try:
        return _document(path, path.read_bytes())
    except (ValueError, IndexError, OverflowError) as error:
        raise unreadable(path, error) from error


def _document(path: Path, content: bytes) -> Document:
    lines = lines_of(content, comments=True)
    header, *counts = lines.words_of(0) if len(lines) else [b""]
    _check_header(path, header, counts)
    counts, begin = (counts, 1) if counts else (lines.words_of(1), 2)
    middle = begin + int(counts[0])
    end = middle + int(counts[1])
    _check_bounds(path, lines.words, begin, middle, end)
    vertices, faces = lines[begin:middle], lines[middle:end]
    del lines
    V = vertices.numbers(path)
    check_vertices(path, V)
    corners, sizes = _polygons(faces)
    part = Part("", V, triangles(corners, sizes, V))
    check_indices(path, part.faces, len(V))
    held = {
        "normals": b"N" in header,
        "colours": b"C" in header,
        "texture coordinates": b"ST" in header,
        "face colours": (faces.words > sizes + 1).any(),
        "polygons": (sizes > 3).any(),
        "comments": b"#" in content,
    }
    normals = vertices.numbers(path, 3) if held["normals"] else None
    contents = [name for name in held if held[name]]
    return _Off(path, [part], contents, content=content, starts=vertices.starts, normals=normals)


def _check_header(path: Path, header: bytes, others: list[bytes]) -> None:
    if not header.endswith(b"OFF"):
        raise unreadable(path, "its first word is not OFF, COFF, NOFF or the like")
    if b"4" in header or b"n" in header or b"BINARY" in others:
        raise unsupported(path, "is binary, or has vertices other than x y z", _REMEDY)


def _check_bounds(path: Path, words: NDArray[np.int32], begin: int, middle: int, end: int) -> None:
    """Raise MeshFileError unless there is a line for each vertex and each face."""
    if begin < middle <= end <= len(words):
        return
    vertices, faces, left = middle - begin, end - middle, len(words) - begin
    if 0 < 3 * vertices + faces <= int(words[begin:].sum()):
        raise unsupported(path, "does not have one line per vertex and face", _REMEDY)
    raise ValueError(f"it claims {vertices} vertices and {faces} faces, in {left} lines")


def _polygons(lines: Lines) -> tuple[Indices, Indices]:
    """Return the corners of all faces, and the number of corners of each."""
    _, ((sizes, corners),), bad, _ = lines.table([True])
    if bad >= 0:
        list(map(int, lines.words_of(bad)[: int(lines.words_of(bad)[0]) + 1]))  # names the word
        raise ValueError("a face has fewer corners than it claims")
    return whole(corners), sizes
