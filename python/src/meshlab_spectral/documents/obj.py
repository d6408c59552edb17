"""OBJ files: the numbers in lines of vertices and normals are replaced."""

from __future__ import annotations

import re
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
)
from meshlab_spectral.documents.normals import following_normals
from meshlab_spectral.documents.off import Lines, ranges, with_numbers, without_comments
from meshlab_spectral.documents.polygons import corners_of_triangles
from meshlab_spectral.documents.side_files import copy_side_files

# Only lines of numbers go on after a backslash: in Shift-JIS a name may end in that byte.
_CONTINUED = re.compile(rb"^[ \t]*(?:v[ntp]?|[flp])[ \t].*(?:\\\r?\n.*)+", re.MULTILINE)
_COMMENT = re.compile(rb"^[ \t]*#", re.MULTILINE)
_KEYWORDS = {
    "normals": (b"vn",),
    "texture coordinates": (b"vt",),
    "materials": (b"mtllib", b"usemtl"),
    "groups": (b"g",),
    "object names": (b"o",),
    "smoothing groups": (b"s",),
    "lines and points": (b"l", b"p"),
}
_FREE_FORM = (b"cstype", b"curv", b"curv2", b"surf")
_NUMBER = rb"[ \t]+[-+]?[\d.]+(?:[eE][-+]?\d+)?(?=[ \t])"
_TEXTURE = re.compile(
    rb"^[ \t]*(?:map_(?!aat\b)\w+|bump|disp|decal|norm|refl)"
    rb"(?:[ \t]+-(?:(?:[ost]|mm)(?:" + _NUMBER + rb"){1,3}|\w+[ \t]+\S+))*[ \t]+(.*)",
    re.MULTILINE | re.IGNORECASE,
)
_LARGEST_LIBRARY = 2**24  # bytes


@dataclass(kw_only=True)
class _Obj(Document):
    text: bytes
    places: Indices  # of coordinates in the text, n x 3 x 2
    normals: Array
    normal_places: Indices
    corner_normals: Indices  # the normal of each corner of the triangles; -1 where it has none
    libraries: list[str]

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        (part,), (after,) = self.parts, moved
        before = part.vertices
        normals = self.normals
        shaded = (self.corner_normals >= 0).all(axis=1)
        if shaded.any():
            normals = following_normals(
                before, after, part.faces[shaded], normals, self.corner_normals[shaded]
            )
        text = with_numbers(
            self.text,
            (self.places, before, after, digits_for(before, after)),
            (self.normal_places, self.normals, normals, SINGLE),
        )
        target.write_bytes(text)
        return copy_side_files(self.path, target, _side_files(self.path.parent, self.libraries))


def read(path: Path) -> Document:
    """Read an OBJ file.

    Raises
    ------
    MeshFileError
        When it is damaged.
    """
    text = path.read_bytes()
    lines = Lines(path, _joined(without_comments(text)))
    vertex_lines, normal_lines = lines.beginning(b"v"), lines.beginning(b"vn")
    if not vertex_lines.size:
        raise unreadable(path, "it has no vertices, which are lines that begin with v")
    words, normal_words = (lines.columns(rows, 1, 4) for rows in (vertex_lines, normal_lines))
    V, normals = lines.numbers(words), lines.numbers(normal_words)
    check_vertices(path, V)
    corners, corner_normals, sizes = _faces(lines, vertex_lines, normal_lines)
    split = corners_of_triangles(corners, sizes, V)
    contents = [name for name, keywords in _KEYWORDS.items() if _has(lines, keywords)]
    held = {
        "colours": (lines.count[vertex_lines] >= 7).any() or b"#MRGB" in text,
        "polygons": (sizes > 3).any(),
        "comments": b"#" in text and _COMMENT.search(text),
    }
    return _Obj(
        path=path,
        parts=[Part("", V, corners[split])],
        contents=contents + [name for name, is_held in held.items() if is_held],
        warnings=[_free_form(path)] if _has(lines, _FREE_FORM) else [],
        text=text,
        places=lines.words[words],
        normals=normals,
        normal_places=lines.words[normal_words],
        corner_normals=corner_normals[split],
        libraries=_libraries(lines, text),
    )


def _joined(text: bytes) -> bytes:
    """Replace the ends of continued lines by as many blanks."""
    if b"\\\n" not in text and b"\\\r\n" not in text:
        return text
    return _CONTINUED.sub(
        lambda lines: re.sub(rb"\\\r?\n", lambda end: b" " * len(end[0]), lines[0]), text
    )


def _has(lines: Lines, keywords: tuple[bytes, ...]) -> bool:
    return any(lines.beginning(keyword).size for keyword in keywords)


def _free_form(path: Path) -> str:
    return f"{path} has free-form curves or surfaces: control points that no face uses do not move"


def _faces(
    lines: Lines, vertex_lines: Indices, normal_lines: Indices
) -> tuple[Indices, Indices, Indices]:
    """Return the vertices and normals of all corners, and the number of corners of each face."""
    rows = lines.beginning(b"f")
    sizes = lines.count[rows] - 1
    begin, end = lines.words[ranges(lines.first[rows] + 1, sizes)].T
    slashes = np.append(np.flatnonzero(lines.letters == ord("/")), 2 * [len(lines.text)])
    slash = np.searchsorted(slashes, begin)
    corners = _absolute(
        lines.integers(begin, np.minimum(slashes[slash], end)), rows, sizes, vertex_lines
    )
    if (corners < 0).any():
        position = begin[np.argmax(corners < 0)]
        raise lines.misplaced(position, f"one of {len(vertex_lines)} vertices, from 1,")
    third = slashes[slash + 1] + 1
    named = np.flatnonzero(third < end)
    normals = np.zeros(len(begin), dtype=np.int64)
    normals[named] = lines.integers(third[named], end[named])
    return corners, _absolute(normals, rows, sizes, normal_lines), sizes


def _absolute(numbers: Indices, rows: Indices, sizes: Indices, lines: Indices) -> Indices:
    """Turn numbers from 1, or relative to a face's line, into indices; -1 where there is none."""
    seen = np.repeat(np.searchsorted(lines, rows), sizes)
    index = np.where(numbers > 0, numbers - 1, np.where(numbers < 0, seen + numbers, -1))
    return np.where((index >= 0) & (index < len(lines)), index, -1)


def _libraries(lines: Lines, text: bytes) -> list[str]:
    """Return what follows each mtllib."""
    begins = lines.words[lines.first[lines.beginning(b"mtllib")], 0].tolist()
    return [_name(text[begin:].split(b"\n", 1)[0].strip()[len(b"mtllib") :]) for begin in begins]


def _name(name: bytes) -> str:
    return name.strip().decode("utf-8", "surrogateescape")


def _side_files(folder: Path, libraries: list[str]) -> list[str]:
    """Return the names, relative to a folder, of material libraries and their textures."""
    names = []
    for line in libraries:
        for library in _one_or_several(folder, line):
            names += [library, *_textures(folder, library)]
    return list(dict.fromkeys(names))


def _one_or_several(folder: Path, line: str) -> list[str]:
    """Return the libraries in a line: one, whose name may hold blanks, or several."""
    several = line.split()
    if (folder / line).is_file() or not any((folder / name).is_file() for name in several):
        return [line]
    return several


def _textures(folder: Path, library: str) -> Iterator[str]:
    """Yield the textures of a library, which are looked for beside it, then in the folder."""
    if not (folder / library).is_file():
        return
    with (folder / library).open("rb") as file:
        text = file.read(_LARGEST_LIBRARY)
    for match in _TEXTURE.finditer(text):
        name = _name(match[1])
        beside = str(PurePosixPath(library).parent / name)
        known = (beside, name, beside.replace("\\", "/"))
        yield next((one for one in known if (folder / one).is_file()), beside)
