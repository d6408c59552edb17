"""OBJ files: the numbers in the lines of vertices and normals are replaced."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral._core import first_equal_rows, text_corners
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.causes import ForeignError, unreadable
from meshlab_spectral.formats.digits import SINGLE, digits_for
from meshlab_spectral.formats.document import Array, Document, Indices, Part, check_vertices
from meshlab_spectral.formats.normals import following_normals
from meshlab_spectral.formats.polygons import corners_of_triangles
from meshlab_spectral.formats.side_files import beside, copy_side_files
from meshlab_spectral.formats.text import Lines, lines_of, write_patched
from meshlab_spectral.warned import Warned

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
_WORD = re.compile(rb"[^\s\\]+")
_DECIMALS = 6  # of normals: those that are equal in them stay one
_COMMENT = re.compile(rb"(?m)^[ \t]*#")


@dataclass(kw_only=True)
class _Obj(Document):
    content: bytes
    starts: Indices  # byte offsets of the lines of vertices
    normal_starts: Indices
    libraries: list[bytes]  # what follows mtllib
    normals: Array
    which: Indices  # the normal of each corner of the triangles; -1 where it has none

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        part, after, which = self.parts[0], moved[0], self.which
        before, faces, content = part.vertices, part.faces, self.content
        starts, normal_starts, old = self.starts, self.normal_starts, self.normals
        normals, warnings = old, list[Warned]()
        if len(old):
            shaded = np.array((which >= 0).all(axis=1))
            if not shaded.all():
                faces, which = faces[shaded], which[shaded]
            if _is_shared(which, faces).any():
                old, normals, content = self._split(after, faces, which, shaded)
                starts, normal_starts = (lines.starts for lines in _lines(content)[:2])
            else:
                normals = following_normals(before, after, faces, old, which)
            if len(old) > len(self.normals):
                more = len(old) - len(self.normals)
                added = "1 normal is" if more == 1 else f"{more} normals are"
                text = f"{added} added, as others serve faces that turn apart"
                warnings.append(Warned("added_normals", text))
        changes = [(starts, 1, before, after, digits_for(before, after))]
        if len(old):
            changes.append((normal_starts, 1, old, normals, SINGLE))
        with target.open("wb") as file:
            write_patched(file, content, changes)
        return warnings + copy_side_files(self.path, target, self.side_files())

    def _split(
        self, after: Array, faces: Indices, which: Indices, shaded: NDArray[np.bool_]
    ) -> tuple[Array, Array, bytes]:
        """Let a normal that serves several faces follow the shape at each of its vertices.

        Returns the normals before and after, and the text, in which some have become several.
        """
        vertices, normals, lines = _lines(self.content)[:3]
        before, old, none = self.parts[0].vertices, self.normals, len(vertices)
        face = np.repeat(np.arange(len(lines)), np.maximum(lines.words - 3, 0))[shaded]
        several = np.zeros(len(old), bool)
        several[which[_is_shared(which, np.repeat(face[:, None], 3, axis=1))]] = True

        def keys_of(normal: Indices, vertex: Indices) -> Indices:
            return normal * (none + 1) + np.where(several[normal], vertex, none)

        keys, corners = np.unique(keys_of(which, faces), return_inverse=True)
        of = keys // (none + 1)
        new = following_normals(before, after, faces, old[of], corners.reshape(-1, 3))
        first = first_equal_rows(np.column_stack([of, np.round(new, _DECIMALS)]))
        is_first = first == np.arange(len(keys))
        counts = np.maximum(np.bincount(of[is_first], minlength=len(old)), 1)
        begins = np.cumsum(counts) - counts
        rank = np.cumsum(is_first) - 1  # among those that differ
        numbers = (begins[of] + rank - rank[np.searchsorted(of, of)])[first]
        result = np.repeat(old, counts, axis=0)
        moved = result.copy()
        moved[numbers] = new
        vertex, normal = _corners(lines, vertices, normals)
        at = np.searchsorted(keys, keys_of(normal, vertex)).clip(max=len(keys) - 1)
        found = keys[at] == keys_of(normal, vertex)  # not of faces that have no triangle
        numbers = np.where(normal < 0, -1, np.where(found, numbers[at], begins[normal]))
        content = self.content
        if counts.max() > 1:
            content = _renumbered(content, normals, counts, lines, numbers)
        return result, moved, content

    def is_harmless(self) -> bool:
        return len(self.libraries) <= _MOST_LIBRARIES and super().is_harmless()

    def side_files(self) -> Iterator[str]:
        """Yield the names of material libraries and their textures."""
        folder = self.path.parent
        for line in dict.fromkeys(map(_name, self.libraries)):
            one_name = _slashed(folder, line)
            is_one = os.path.isfile(folder / one_name)  # noqa: PTH113 - false for impossible names
            words = [one_name] if is_one else [_slashed(folder, w) for w in line.split()]
            for library in dict.fromkeys(words):
                yield library
                try:
                    content = beside(self.path, library).read_bytes()
                except MeshFileError:  # told when it is copied
                    continue
                for texture in dict.fromkeys(_TEXTURE.findall(content)):
                    name = _name(texture).replace("\\", "/")
                    yield str(PurePosixPath(library).parent / name)


def _is_shared(which: Indices, owners: Indices) -> NDArray[np.bool_]:
    """Whether a normal has another owner, too, at each corner."""
    owner = np.zeros(which.max(initial=0) + 1, np.int64)
    owner[which] = owners
    shared: NDArray[np.bool_] = owner[which] != owners
    return shared


def _renumbered(
    content: bytes, normals: Lines, counts: Indices, faces: Lines, numbers: Indices
) -> bytes:
    """Return the text with so many lines for each normal, and new numbers of these in its faces."""
    edits = list[tuple[int, int, bytes]]()  # begin, end, and what stands there
    for k in np.flatnonzero(counts > 1).tolist():
        line = normals.line(k).partition(b"#")[0].rstrip()
        begin = int(normals.starts[k])
        edits.append((begin, begin, (line + b"\n") * (int(counts[k]) - 1)))
    corner = 0
    for k in range(len(faces)):
        words = _WORD.finditer(content, int(faces.starts[k]))
        for word in islice(words, 1, int(faces.words[k])):
            if numbers[corner] >= 0:
                begin = word.start() + word[0].rindex(b"/") + 1
                edits.append((begin, word.end(), b"%d" % (numbers[corner] + 1)))
            corner += 1
    edits.sort()
    pieces, end = list[bytes](), 0
    for begin, after, text in edits:
        pieces += [content[end:begin], text]
        end = after
    return b"".join([*pieces, content[end:]])


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
    vertices, normals, faces, libraries, kinds = _lines(content)
    found = {_CONTENTS[_KEYWORDS[k]] for k in kinds if 2 <= k < len(_KEYWORDS)}
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


def _lines(content: bytes) -> tuple[Lines, Lines, Lines, Lines, list[int]]:
    """Return the lines of vertices, normals, faces and libraries, and the kinds of all lines."""
    lines = lines_of(content, _KEYWORDS, comments=True, continued=_CONTINUED)
    vertices, normals, faces, libraries = (
        lines[lines.kinds == kind] for kind in (_VERTEX, _NORMAL, _FACE, _LIBRARY)
    )
    return vertices, normals, faces, libraries, np.unique(lines.kinds).tolist()


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
        line = faces.line_number(int(face))
        raise ValueError(f"the face in line {line} has a corner that refers to a missing vertex")
    return corners, _indices(found[:, 1], faces, normals)


def _indices(numbers: Indices, faces: Lines, lines: Lines) -> Indices:
    """Turn numbers from 1, or relative to a face's line, into indices; -1 if out of range."""
    index = numbers - 1
    if (numbers < 0).any():
        before = np.repeat(np.searchsorted(lines.starts, faces.starts), faces.words - 1)
        index = np.where(numbers < 0, before + numbers, index)
    return np.where((index >= 0) & (index < len(lines)), index, -1)
