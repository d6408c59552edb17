"""OBJ files: the numbers in the lines of vertices and normals are replaced."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np

from meshlab_spectral._core import text_corners
from meshlab_spectral.documents.causes import ForeignError, unreadable
from meshlab_spectral.documents.digits import SINGLE, digits_for
from meshlab_spectral.documents.document import Array, Document, Indices, Part, check_vertices
from meshlab_spectral.documents.normals import following_normals
from meshlab_spectral.documents.polygons import corners_of_triangles
from meshlab_spectral.documents.side_files import beside, copy_side_files
from meshlab_spectral.documents.text import Lines, lines_of, write_patched
from meshlab_spectral.errors import MeshFileError

_CONTENTS = {
    "vn": "normals",
    "vt": "texture coordinates",
    "mtllib": "materials",
    "usemtl": "materials",
    "g": "groups",
    "o": "object names",
    "s": "smoothing groups",
    "l": "lines and points",
    "p": "lines and points",
    "cstype": "free-form curves or surfaces",
}
_TEXTURE = re.compile(
    rb"^[ \t]*(?:map_(?!aat\b)\w+|bump|disp|decal|norm|refl)"
    rb"(?:[ \t]+-\w+(?:[ \t]+(?:on|off|sphere|cube_\w+|[rgbmlz]|[-+\d.e]+)(?=[ \t]))*)*[ \t]+(.*)",
    re.MULTILINE | re.IGNORECASE,
)
_MOST_LIBRARIES = 100  # MeshLab reads each as often as it is named
_KEYWORDS = ["v", "f", *_CONTENTS]
_CONTINUED = 3  # vertices, faces and normals, which may go on after a backslash
_VERTEX, _FACE, _NORMAL, _LIBRARY = map(_KEYWORDS.index, ("v", "f", "vn", "mtllib"))
_COMMENT = re.compile(rb"(?m)^[ \t]*#")


@dataclass(kw_only=True)
class _Obj(Document):
    content: bytes
    starts: Indices  # byte offsets of the lines of vertices
    normal_starts: Indices
    libraries: list[bytes]  # what follows mtllib
    normals: Array
    which: Indices  # the normal of each corner of the triangles; -1 where it has none

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        part, after, which = self.parts[0], moved[0], self.which
        before, faces = part.vertices, part.faces
        changes = [(self.starts, 1, before, after, digits_for(before, after))]
        if len(self.normals):
            shaded = (which >= 0).all(axis=1)
            if not shaded.all():
                faces, which = faces[shaded], which[shaded]
            normals = following_normals(before, after, faces, self.normals, which)
            changes.append((self.normal_starts, 1, self.normals, normals, SINGLE))
        with target.open("wb") as file:
            write_patched(file, self.content, changes)
        return copy_side_files(self.path, target, self.side_files())

    def is_harmless(self) -> bool:
        return len(self.libraries) <= _MOST_LIBRARIES and super().is_harmless()

    def side_files(self) -> Iterator[str]:
        """Yield the names of material libraries and their textures."""
        folder = self.path.parent
        for line in dict.fromkeys(map(_name, self.libraries)):
            whole = _slashed(folder, line)
            is_one = os.path.isfile(folder / whole)  # noqa: PTH113 - false for impossible names
            words = [whole] if is_one else [_slashed(folder, w) for w in line.split()]
            for library in dict.fromkeys(words):
                yield library
                try:
                    content = beside(self.path, library).read_bytes()
                except MeshFileError:  # told when it is copied
                    continue
                for texture in dict.fromkeys(_TEXTURE.findall(content)):
                    name = _name(texture).replace("\\", "/")
                    yield str(PurePosixPath(library).parent / name)


def _name(name: bytes) -> str:
    return re.sub(r'^"(.*)"$', r"\1", name.strip().decode("utf-8", "surrogateescape"))


def _slashed(folder: Path, name: str) -> str:
    """Return a name with the slashes of this system, unless there is such a file in `folder`."""
    is_file = os.path.isfile(folder / name)  # noqa: PTH113
    return name if is_file else str(PurePosixPath(name.replace("\\", "/")))


def read(path: Path) -> Document:
    """Read an OBJ file; raise MeshFileError when it is damaged."""
    try:
        return _document(path, path.read_bytes())
    except (ValueError, IndexError, OverflowError) as error:
        raise unreadable(path, error) from error


def _document(path: Path, content: bytes) -> Document:
    lines = lines_of(content, _KEYWORDS, comments=True, continued=_CONTINUED)
    vertices, normals, faces, libraries = (
        lines[lines.kinds == kind] for kind in (_VERTEX, _NORMAL, _FACE, _LIBRARY)
    )
    found = {_CONTENTS[_KEYWORDS[k]] for k in np.unique(lines.kinds) if 2 <= k < len(_KEYWORDS)}
    del lines
    if not len(vertices):
        raise ForeignError("it has no vertices, which are lines that begin with v")
    V = vertices.numbers(path, 1)
    check_vertices(path, V)
    corners, which = _corners(faces, vertices, normals)
    split = corners_of_triangles(corners, faces.words - 1, V)
    more: dict[str, object] = {
        "colours": (vertices.words > 6).any(),
        "polygons": (faces.words > 4).any(),
        "comments": b"#" in content and _COMMENT.search(content),
    }
    contents = [name for name in dict.fromkeys(_CONTENTS.values()) if name in found]
    return _Obj(
        path,
        [Part("", V, corners[split])],
        contents + [name for name in more if more[name]],
        content=content,
        starts=vertices.starts,
        normal_starts=normals.starts,
        libraries=[libraries.line(k).removeprefix(b"mtllib") for k in range(len(libraries))],
        normals=normals.numbers(path, 1),
        which=which[split],
        largest_face=int(faces.words.max(initial=1)) - 1,
    )


def _corners(faces: Lines, vertices: Lines, normals: Lines) -> tuple[Indices, Indices]:
    """Return the vertex and normal indices of all corners."""
    found, bad = text_corners(faces.text, faces.starts, faces.words)
    if bad >= 0:
        word = faces.text[bad:].split(maxsplit=1)[0].partition(b"#")[0]
        parts = word.removesuffix(b"\\").split(b"/")
        np.array(
            [int(part or 0) if k else int(part) for k, part in enumerate(parts)][::2], np.int64
        )
        raise ValueError(f"{word!r} is not a corner")
    corners = _indices(found[:, 0], faces, vertices)
    if (corners < 0).any():
        face = np.searchsorted(np.cumsum(faces.words - 1), np.argmax(corners < 0), side="right")
        line = faces.place(int(face))
        raise ValueError(f"the face in line {line} has a corner that refers to a missing vertex")
    return corners, _indices(found[:, 1], faces, normals)


def _indices(numbers: Indices, faces: Lines, lines: Lines) -> Indices:
    """Turn numbers from 1, or relative to a face's line, into indices; -1 if out of range."""
    index = numbers - 1
    if (numbers < 0).any():
        before = np.repeat(np.searchsorted(lines.starts, faces.starts), faces.words - 1)
        index = np.where(numbers < 0, before + numbers, index)
    return np.where((index >= 0) & (index < len(lines)), index, -1)
