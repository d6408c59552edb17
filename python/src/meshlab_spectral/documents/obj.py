"""OBJ files: the numbers in the lines of vertices and normals are replaced."""

from __future__ import annotations

import os
import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np

from meshlab_spectral.documents.digits import SINGLE, digits_for
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
from meshlab_spectral.documents.polygons import corners_of_triangles
from meshlab_spectral.documents.side_files import copy_side_files
from meshlab_spectral.documents.text import Words, numbers, replace_numbers

_CONTENTS = {
    b"vn": "normals",
    b"vt": "texture coordinates",
    b"mtllib": "materials",
    b"usemtl": "materials",
    b"g": "groups",
    b"o": "object names",
    b"s": "smoothing groups",
    b"l": "lines and points",
    b"p": "lines and points",
    b"cstype": "free-form curves or surfaces",
}
_TEXTURE = re.compile(
    rb"^[ \t]*(?:map_(?!aat\b)\w+|bump|disp|decal|norm|refl)"
    rb"(?:[ \t]+-\w+(?:[ \t]+(?:on|off|sphere|cube_\w+|[rgbmlz]|[-+\d.e]+)(?=[ \t]))*)*[ \t]+(.*)",
    re.MULTILINE | re.IGNORECASE,
)


@dataclass(kw_only=True)
class _Obj(Document):
    lines: list[bytes]
    where: dict[bytes, list[int]]  # the line numbers of each keyword
    normals: Array
    which: Indices  # the normal of each corner of the triangles; -1 where it has none

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        part, after, lines = self.parts[0], moved[0], self.lines.copy()
        before, which = part.vertices, self.which
        replace_numbers(lines, self.where[b"v"], 1, before, after, digits_for(before, after))
        shaded = (which >= 0).all(axis=1)
        faces, which = part.faces[shaded], which[shaded]
        normals = following_normals(before, after, faces, self.normals, which)
        replace_numbers(lines, self.where[b"vn"], 1, self.normals, normals, SINGLE)
        target.write_bytes(b"".join(lines))
        return copy_side_files(self.path, target, self._side_files())

    def _side_files(self) -> Iterator[str]:
        """Yield the names of material libraries and their textures, relative to the file."""
        folder = self.path.parent
        for number in self.where[b"mtllib"]:
            line = _name(self.lines[number].partition(b"mtllib")[2])
            is_one = os.path.isfile(folder / line)  # noqa: PTH113 - false for impossible names
            for library in [line] if is_one else line.split():
                yield library
                if os.path.isfile(folder / library):  # noqa: PTH113
                    for texture in _TEXTURE.findall((folder / library).read_bytes()):
                        name = _name(texture).replace("\\", "/")
                        yield str(PurePosixPath(library).parent / name)


def _name(name: bytes) -> str:
    return name.strip().decode("utf-8", "surrogateescape")


def read(path: Path) -> Document:
    """Read an OBJ file; raise MeshFileError when it is damaged."""
    try:
        return _document(path, path.read_bytes().splitlines(keepends=True))
    except (ValueError, IndexError, OverflowError) as error:
        raise unreadable(path, error) from error


def _document(path: Path, lines: list[bytes]) -> Document:
    where: dict[bytes, list[int]] = defaultdict(list)
    rows: dict[bytes, list[Words]] = defaultdict(list)
    for number, row in _rows(lines):
        where[row[0]].append(number)
        rows[row[0]].append(tuple(row))  # lists would slow the garbage collector
    vertices, normals, faces = rows[b"v"], rows[b"vn"], rows[b"f"]
    if not vertices:
        raise ValueError("it has no vertices, which are lines that begin with v")
    if any(row[-1].endswith(b"\\") for row in vertices + normals):
        raise unsupported(path, "has vertices that span several lines", "write each on one line")
    V = numbers(path, vertices, 1)
    check_vertices(path, V)
    sizes = np.array([len(row) - 1 for row in faces], dtype=np.int64)
    corners, which = _corners(faces, np.repeat(where[b"f"], sizes), where)
    split = corners_of_triangles(corners, sizes, V)
    held = {name: True for keyword, name in _CONTENTS.items() if where[keyword]} | {
        "colours": any(len(row) > 6 for row in vertices),
        "polygons": bool((sizes > 3).any()),
        "comments": any(line.lstrip().startswith(b"#") for line in lines),
    }
    contents = [name for name, is_held in held.items() if is_held]
    N = numbers(path, normals, 1)
    parts = [Part("", V, corners[split])]
    return _Obj(path, parts, contents, lines=lines, where=where, normals=N, which=which[split])


def _rows(lines: list[bytes]) -> Iterator[tuple[int, list[bytes]]]:
    """Yield the number and words of each line; a continued face has its last line's number."""
    row: list[bytes] = []
    for number, line in enumerate(lines):
        row += line.partition(b"#")[0].split()
        if row and row[0] == b"f" and row[-1].endswith(b"\\"):
            row[-1:] = row[-1][:-1].split()
        elif row:
            yield number, row
            row = []


def _corners(
    faces: list[Words], owners: Indices, where: dict[bytes, list[int]]
) -> tuple[Indices, Indices]:
    """Return the vertex and normal indices of all corners; `owners` are their line numbers."""
    words = [word for row in faces for word in row[1:]]
    corners = _indices([int(word.split(b"/")[0]) for word in words], owners, where[b"v"])
    if (corners < 0).any():
        line = owners[np.argmax(corners < 0)] + 1
        raise ValueError(f"the face in line {line} has a corner that refers to a missing vertex")
    normals = [int(word.split(b"/")[2] or 0) if word.count(b"/") > 1 else 0 for word in words]
    return corners, _indices(normals, owners, where[b"vn"])


def _indices(chosen: list[int], owners: Indices, lines: list[int]) -> Indices:
    """Turn numbers from 1, or relative to a face's line, into indices; -1 if out of range."""
    number = np.array(chosen, dtype=np.int64)
    index = np.where(number > 0, number - 1, np.searchsorted(lines, owners) + number)
    return np.where((number != 0) & (index >= 0) & (index < len(lines)), index, -1)
