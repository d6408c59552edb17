"""STL files, binary and text: corners that coincide are one vertex of a connected surface."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.documents.digits import SINGLE, digits_for, precision_warning
from meshlab_spectral.documents.document import Array, Document, Indices, Part, unreadable
from meshlab_spectral.documents.off import Lines, with_numbers
from meshlab_spectral.errors import MeshFileError

_HEADER, _LOOKED_AT = 84, 1000  # bytes
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_EXCESS = 1 / 20  # of its length, which a binary file may have at its end


@dataclass(kw_only=True)
class _BinaryStl(Document):
    content: bytes
    count: int

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        (part,), (after,) = self.parts, moved
        content = bytearray(self.content)
        rows = np.frombuffer(content, _TRIANGLE, self.count, _HEADER)
        changed = (after != part.vertices)[part.faces]
        rows["corners"][changed] = after[part.faces][changed]
        rows["normal"] = _following(rows["normal"], part, after)
        target.write_bytes(content)
        warning = precision_warning(part.vertices, after, target.name)
        return [] if warning is None else [warning]


@dataclass(kw_only=True)
class _TextStl(Document):
    content: bytes
    places: Indices  # of coordinates in the text, m x 3 x 3 x 2
    normals: Array
    normal_places: Indices

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        (part,), (after,) = self.parts, moved
        before, faces = part.vertices, part.faces
        normals = _following(self.normals, part, after)
        text = with_numbers(
            self.content,
            (self.places, before[faces], after[faces], digits_for(before, after)),
            (self.normal_places, self.normals, normals, SINGLE),
        )
        target.write_bytes(text)
        return []


def read(path: Path) -> Document:
    """Read an STL file.

    Raises
    ------
    MeshFileError
        When it is damaged.
    """
    content = path.read_bytes()
    count = _binary_count(content)
    return _read_text(path, content) if count is None else _read_binary(path, content, count)


def _binary_count(content: bytes) -> int | None:
    """Return the number of triangles that a binary file claims to hold; None of a text."""
    if len(content) < _HEADER:
        return None
    count: int = struct.unpack_from("<I", content, _HEADER - 4)[0]
    head = content[: _HEADER + _LOOKED_AT]
    # A binary file may begin with the word solid, as a text does.
    is_whole = len(content) == _HEADER + _TRIANGLE.itemsize * count
    return None if head.isascii() and b"\0" not in head and not is_whole else count


def _read_binary(path: Path, content: bytes, count: int) -> Document:
    claimed = _HEADER + _TRIANGLE.itemsize * count
    if not claimed <= len(content) <= claimed * (1 + _EXCESS):
        size = len(content)
        raise unreadable(path, f"it claims {count} triangles, which does not fit its {size} bytes")
    rows = np.frombuffer(content, _TRIANGLE, count, _HEADER)
    return _BinaryStl(
        path=path,
        parts=[_connected(path, rows["corners"].astype(np.float64))],
        contents=["attribute bytes"] if rows["attribute"].any() else [],
        content=content,
        count=count,
    )


def _read_text(path: Path, content: bytes) -> Document:
    lines = Lines(path, content.lower())
    facets, corners = lines.beginning(b"facet"), lines.beginning(b"vertex")
    _check_structure(lines, facets, corners)
    normal_words = lines.columns(facets, 2, 5)
    words = lines.columns(corners, 1, 4).reshape(-1, 3, 3)
    named = lines.count[lines.beginning(b"solid")] > 1
    return _TextStl(
        path=path,
        parts=[_connected(path, lines.numbers(words))],
        contents=["names of solids"] if named.any() else [],
        content=content,
        places=lines.words[words],
        normals=lines.numbers(normal_words),
        normal_places=lines.words[normal_words],
    )


def _check_structure(lines: Lines, facets: Indices, corners: Indices) -> None:
    """Raise MeshFileError unless each facet has three corners and an end."""
    ends = lines.beginning(b"endfacet")
    begins = np.append(facets, len(lines.first))
    wrong = np.diff(np.searchsorted(corners, begins)) != 3
    wrong |= np.diff(np.searchsorted(ends, begins)) != 1
    if wrong.any():
        line = lines.line_number(lines.words[lines.first[facets[np.argmax(wrong)]], 0])
        raise unreadable(lines.path, f"the facet in line {line} has not three corners and an end")
    if len(corners) != 3 * len(facets):
        raise unreadable(lines.path, "it has a corner before the first facet")


def _connected(path: Path, corners: Array) -> Part:
    """Make one vertex of corners (m x 3 x 3) that coincide, in the order of their appearance."""
    if not len(corners):
        raise unreadable(path, "it has no triangles")
    with np.errstate(over="ignore"):
        lost = ~np.isfinite(corners.astype(np.float32)).all(axis=2)
    if lost.any():
        triangle, corner = np.argwhere(lost)[0]
        x, y, z = corners[triangle, corner]
        raise MeshFileError(
            f"{path}: a corner of triangle {triangle} is at {x:g} {y:g} {z:g}, which is not finite "
            "or too large: correct it, or open and save the file in MeshLab, which deletes such "
            "vertices with their faces"
        )
    points = corners.reshape(-1, 3)
    x, y, z = (np.unique(column, return_inverse=True)[1] for column in points.T)
    xy = np.unique(x << 32 | y, return_inverse=True)[1]
    _, first, index = np.unique(xy << 32 | z, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return Part("", points[first[order]], rank[index].reshape(-1, 3))


def _following(normals: NDArray[np.floating], part: Part, after: Array) -> Array:
    """Return the normals of facets, those of moved triangles computed anew.

    They stay on the side of the surface where they were; a facet without normal or without area
    keeps what it has.
    """
    new, old = (_area_vectors(shape[part.faces]) for shape in (after, part.vertices))
    length = np.linalg.norm(new, axis=1)
    moved = (after != part.vertices).any(axis=1)[part.faces].any(axis=1)
    chosen = moved & (length > 0) & normals.any(axis=1)
    new[np.einsum("ij,ij->i", normals, old) < 0] *= -1
    result = normals.astype(np.float64)
    result[chosen] = new[chosen] / length[chosen, None]
    return result


def _area_vectors(corners: Array) -> Array:
    """Return a normal of each triangle, twice as long as its area."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
