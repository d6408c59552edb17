"""OFF files: the numbers in the lines of vertices are replaced."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.causes import (
    EndsEarlyError,
    ForeignError,
    MayEndEarlyError,
    unreadable,
    unsupported,
)
from meshlab_spectral.formats.digits import SINGLE, digits_for
from meshlab_spectral.formats.document import (
    Array,
    Document,
    Indices,
    Part,
    check_indices,
    check_vertices,
)
from meshlab_spectral.formats.normals import area_vectors, following_normals
from meshlab_spectral.formats.polygons import triangles
from meshlab_spectral.formats.rows import chunks
from meshlab_spectral.formats.text import (
    Change,
    Lines,
    as_integers,
    lines_of,
    rows_in_any_lines,
    write_patched,
)
from meshlab_spectral.warned import Warned

_REMEDY = "save it as PLY, or as text OFF with vertices x y z"


_HEADER = re.compile(rb"(?P<letters>(?:ST|C|N|4|n)*)OFF(?P<count>[+-]?\d*)")


@dataclass(kw_only=True)
class _Off(Document):
    content: bytes
    starts: Indices  # byte offsets of the vertices
    normals: int | None  # the word of the first coordinate of their normals, if there are any
    directions: Array  # n x 3 normals

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        (part,), (after,) = self.parts, moved
        before, digits = part.vertices, digits_for(part.vertices, after)
        changes: list[Change] = [(self.starts, 0, before, after, digits)]
        if self.normals is not None:
            normals = following_normals(before, after, part.faces, self.directions)
            changes.append((self.starts, self.normals, self.directions, normals, SINGLE))
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
    letters, counts, begin = _header(path, lines)
    n, m = counts
    rows = lines[begin:]
    del lines
    if min(n, m) < 0 or 3 * n + m > int(rows.words.sum()):
        raise EndsEarlyError(f"it claims {n} vertices and {m} faces, in {len(rows)} lines")
    try:
        table, corners, sizes = _numbers(path, rows, counts, b"N" in letters)
    except (ValueError, MeshFileError):
        found = _in_any_lines(rows, counts, letters)
        if found is None:
            raise
        rows = found
        table, corners, sizes = _numbers(path, rows, counts, b"N" in letters)
    starts, has_colours = rows.starts[:n].copy(), bool((rows.words[n : n + m] > sizes + 1).any())
    del rows
    V = np.ascontiguousarray(table[:, :3])
    check_vertices(path, V)
    part = Part("", V, triangles(corners, sizes, V))
    check_indices(path, part.faces, len(V))
    normals = _normals(letters, table, part)
    kinds = {
        "normals": b"N" in letters,
        "colours": b"C" in letters,
        "texture coordinates": b"ST" in letters,
        "face colours": has_colours,
        "polygons": (sizes > 3).any(),
        "comments": b"#" in content,
    }
    contents = [name for name, is_there in kinds.items() if is_there]
    largest = int(sizes.max(initial=3))
    return _Off(
        path,
        [part],
        contents,
        content=content,
        starts=starts,
        normals=normals,
        directions=table[:, normals : normals + 3].copy() if normals else V[:0],
        largest_face=largest,
    )


def _header(path: Path, lines: Lines) -> tuple[bytes, tuple[int, int], int]:
    """Return the letters before OFF, the numbers of vertices and faces, and the next line."""
    first, *counts = lines.words_of(0) if len(lines) else [b""]
    match = _HEADER.fullmatch(first.upper() if first.islower() else first)  # nOFF is not NOFF
    if not match:
        raise ForeignError("its first word is not OFF, COFF, NOFF or the like")
    letters = match["letters"]
    if b"4" in letters or b"n" in letters or b"BINARY" in counts:
        raise unsupported(path, "is binary, or has vertices other than x y z", _REMEDY)
    counts, begin = [one for one in [match["count"], *counts] if one], 1
    while len(counts) < 2 and begin < len(lines):
        counts += lines.words_of(begin)
        begin += 1
    if len(counts) < 2:
        raise EndsEarlyError("it ends before the numbers of vertices and faces")
    return letters, (int(counts[0]), int(counts[1])), begin


def _numbers(
    path: Path, rows: Lines, counts: tuple[int, int], has_normals: bool
) -> tuple[Array, Indices, Indices]:
    """Return the numbers of vertices, a row for each, and the corners and sizes of faces."""
    (n, m), vertices = counts, rows[: counts[0]]
    if len(rows) < n + m:
        raise MayEndEarlyError(f"it claims {n} vertices and {m} faces, in {len(rows)} lines")
    if not n:
        raise ValueError("it has no vertices")
    width = max(6, int(vertices.words.min())) if has_normals else 3
    table, faces = vertices.numbers(path, count=width), rows[n : n + m]
    _, ((sizes, corners),), bad, _ = faces.table([True])
    if bad >= 0:
        list(map(int, faces.words_of(bad)[: int(faces.words_of(bad)[0]) + 1]))  # names the word
        raise faces.fault(bad, f"face {bad} has fewer corners than it claims")
    return table, as_integers(corners), sizes


def _in_any_lines(rows: Lines, counts: tuple[int, int], letters: bytes) -> Lines | None:
    """Return the rows of vertices and faces whatever lines they stand in, if that is possible."""
    width = 3 + 3 * (b"N" in letters) + 2 * (b"ST" in letters)
    layouts = [
        [([False] * (width + of_vertex), counts[0]), ([True] + [False] * of_face, counts[1])]
        for of_vertex in ((4, 3) if b"C" in letters else (0,))
        for of_face in (0, 3, 4, 1)  # numbers of its colour
    ]
    for found in rows_in_any_lines(rows, int(rows.starts[0]), *layouts):
        faces = found[counts[0] :]
        has_colours = int(faces.table([True])[1][0][0].sum()) + len(faces) < int(faces.words.sum())
        if not has_colours or np.isin(faces.starts[1:], rows.starts).all():  # each ends a line
            return found
    return None


def _normals(letters: bytes, table: Array, part: Part) -> int | None:
    """Return the first column of the normals.

    Geomview writes them before the colours, MeshLab after them: they are where they fit the shape.
    """
    if b"N" not in letters:
        return None
    last = table.shape[1] - 2 * (b"ST" in letters) - 3
    if b"C" not in letters or last <= 3:
        return 3
    first, second = (_agreement(table[:, k : k + 3], part) for k in (3, last))
    return 3 if first >= second else int(last)


def _agreement(normals: Array, part: Part) -> float:
    """Return how well vectors at the vertices agree with the shape's normals, up to their sign."""
    total = 0.0
    for i, j in chunks(len(part.faces), 1 << 16):  # all corners at once take 144 bytes a vertex
        faces = part.faces[i:j]
        sums = normals[faces].sum(axis=1)
        length = np.linalg.norm(sums, axis=1)
        along = np.einsum("ij,ij->i", area_vectors(part.vertices, faces), sums)
        total += float((along / np.where(length > 0, length, 1)).sum())
    return abs(total)
