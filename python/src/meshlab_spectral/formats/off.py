"""OFF files: the numbers in the lines of vertices are replaced."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
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
from meshlab_spectral.formats.text import Change, Lines, as_integers, lines_of, write_patched
from meshlab_spectral.warned import Warned

_REMEDY = "save it as PLY, or as text OFF with vertices x y z"


_HEADER = re.compile(rb"(?P<letters>(?:ST|C|N|4|n)*)OFF(?P<count>[+-]?\d*)")


@dataclass(kw_only=True)
class _Off(Document):
    content: bytes
    rows: _Rows

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        (part,), (after,) = self.parts, moved
        rows = self.rows
        digits = digits_for(part.vertices, after)
        changes = [rows.change(0, part.vertices, after, digits)]
        if rows.normals is not None:
            before = rows.table[:, rows.normals : rows.normals + 3]
            normals = following_normals(part.vertices, after, part.faces, before)
            changes.append(rows.change(rows.normals, before, normals, SINGLE))
        if rows.starts is None:  # as one row
            changes = [_merged(changes, rows)]
        with target.open("wb") as file:
            write_patched(file, self.content, changes)
        return []


@dataclass(kw_only=True)
class _Rows:
    """The numbers of the vertices."""

    table: Array  # n x k
    starts: Indices | None  # byte offsets of the rows; None if these are not lines
    begin: int  # of the first
    normals: int | None = None  # the column of the first coordinate, if there are normals

    def change(self, column: int, before: Array, after: Array, digits: int) -> Change:
        starts = np.zeros(0, np.int64) if self.starts is None else self.starts
        return starts, column, before, after, digits


def _merged(changes: Sequence[Change], rows: _Rows) -> Change:
    """Merge changes of columns to a change of all numbers, which may stand in any lines."""
    after = rows.table.copy()
    for _, column, _, new, _ in changes:
        after[:, column : column + 3] = new
    digits = max(digits for *_, digits in changes)
    start = np.array([rows.begin])
    return start, 0, rows.table.reshape(1, -1), after.reshape(1, -1), digits


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
    words, line = _places(letters), lines[begin : begin + n]
    if min(n, m) < 0 or 3 * n + m > int(lines.words[begin:].sum()):
        left = len(lines) - begin
        raise EndsEarlyError(f"it claims {n} vertices and {m} faces, in {left} lines")
    try:
        rows, faces = _by_lines(
            path, line, lines[begin + n : begin + n + m], counts, b"N" in letters
        )
    except (ValueError, MeshFileError):
        found = _by_words(lines[begin:], counts, words)
        if found is None:
            raise
        rows, faces = found
    del lines, line
    V = rows.table[:, :3].copy()
    check_vertices(path, V)
    corners, sizes, has_colours = faces
    part = Part("", V, triangles(corners, sizes, V))
    check_indices(path, part.faces, len(V))
    rows.normals = _normals(letters, rows.table, part)
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
    return _Off(path, [part], contents, content=content, rows=rows, largest_face=largest)


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


def _places(letters: bytes) -> list[int]:
    """Return how many words a vertex may have."""
    rest = 3 + 3 * (b"N" in letters) + 2 * (b"ST" in letters)
    return [rest + colours for colours in ((4, 3) if b"C" in letters else (0,))]


_Faces = tuple[Indices, Indices, bool]  # corners, sizes of faces, and whether these have colours


def _by_lines(
    path: Path, vertices: Lines, faces: Lines, counts: tuple[int, int], has_normals: bool
) -> tuple[_Rows, _Faces]:
    """Read one vertex and one face from each line."""
    if (len(vertices), len(faces)) != counts:
        left = len(vertices) + len(faces)
        raise MayEndEarlyError(
            f"it claims {counts[0]} vertices and {counts[1]} faces, in {left} lines"
        )
    if not counts[0]:
        raise ValueError("it has no vertices")
    width = max(6, int(vertices.words.min())) if has_normals else 3
    table = vertices.numbers(path, count=width)
    _, ((sizes, corners),), bad, _ = faces.table([True])
    if bad >= 0:
        list(map(int, faces.words_of(bad)[: int(faces.words_of(bad)[0]) + 1]))  # names the word
        raise faces.fault(bad, f"face {bad} has fewer corners than it claims")
    has_colours = bool((faces.words > sizes + 1).any())
    rows = _Rows(table=table, starts=vertices.starts, begin=int(vertices.starts[0]))
    return rows, (as_integers(corners), sizes, has_colours)


def _by_words(
    lines: Lines, counts: tuple[int, int], widths: Sequence[int]
) -> tuple[_Rows, _Faces] | None:
    """Read vertices and faces whatever lines they stand in; None if that is not possible."""
    total = int(lines.words.sum())
    begin = int(lines.starts[0])
    single = replace(
        lines[:1], words=np.array([total], np.int32), kinds=np.zeros(1, np.uint8), text=lines.text
    )
    values, _, bad, _ = single.table([False] * total)
    if bad >= 0:
        return None
    numbers = values[0]
    ends = np.cumsum(lines.words, dtype=np.int64)
    for width in widths:
        for has_colours in (False, True):
            faces = _faces_in(numbers, counts[0] * width, counts[1], ends if has_colours else None)
            if faces is not None:
                table = numbers[: counts[0] * width].reshape(-1, width)
                return _Rows(table=table, starts=None, begin=begin), (*faces, has_colours)
    return None


def _faces_in(
    numbers: Array, at: int, count: int, ends: Indices | None
) -> tuple[Indices, Indices] | None:
    """Read faces one after the other; with the `ends` of lines, each is followed by a colour."""
    corners, sizes = list[Array](), list[int]()
    for _ in range(count):
        size = int(numbers[at]) if at < len(numbers) and numbers[at] >= 0 else -1
        if size < 0 or size != numbers[at] or at + 1 + size > len(numbers):
            return None
        corners.append(numbers[at + 1 : at + 1 + size])
        sizes.append(size)
        at += 1 + size
        if ends is not None:
            at = int(ends[np.searchsorted(ends, at)])
    if at != len(numbers):
        return None
    return as_integers(np.concatenate([numbers[:0], *corners])), np.array(sizes, np.int64)


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
