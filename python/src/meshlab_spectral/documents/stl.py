"""STL files, binary and text: coincident corners are merged into one vertex."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.documents.digits import SINGLE, digits_for, precision_warnings
from meshlab_spectral.documents.document import Array, Document, Part, check_vertices, unreadable
from meshlab_spectral.documents.text import numbers, replace_numbers

_HEADER, _LOOKED_AT = 84, 1000  # bytes
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_EXCESS = 1 / 20  # trailing bytes that a binary file may have, relative to its size
_FACET = [b"facet", b"vertex", b"vertex", b"vertex", b"endfacet"]  # loops left out


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
        return precision_warnings(part.vertices, after, target.name)


@dataclass(kw_only=True)
class _TextStl(Document):
    lines: list[bytes]
    facets: list[int]  # line numbers
    corners: list[int]
    normals: Array

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        (part,), (after,), lines = self.parts, moved, self.lines.copy()
        before, corners = part.vertices, part.faces.ravel()
        digits = digits_for(before, after)
        replace_numbers(lines, self.corners, 1, before[corners], after[corners], digits)
        normals = _following(self.normals, part, after)
        replace_numbers(lines, self.facets, 2, self.normals, normals, SINGLE)
        target.write_bytes(b"".join(lines))
        return []


def read(path: Path) -> Document:
    """Read an STL file; raise MeshFileError when it is damaged."""
    content = path.read_bytes()
    try:
        return _read_text(path, content) if _is_text(content) else _read_binary(path, content)
    except (ValueError, IndexError) as error:
        raise unreadable(path, error) from error


def _is_text(content: bytes) -> bool:
    head = content[: _HEADER + _LOOKED_AT]
    if len(head) < _HEADER:
        return True
    # A binary file may begin with the word solid, like a text file.
    is_whole = len(content) == _size(content)
    return head.isascii() and b"\0" not in head and not is_whole


def _count(content: bytes) -> int:
    """Return the number of triangles that a binary file claims to hold."""
    count: int = struct.unpack_from("<I", content, _HEADER - 4)[0]
    return count


def _size(content: bytes) -> int:
    return _HEADER + _TRIANGLE.itemsize * _count(content)


def _read_binary(path: Path, content: bytes) -> Document:
    count, size = _count(content), len(content)
    if not _size(content) <= size <= _size(content) * (1 + _EXCESS):
        raise ValueError(f"it claims {count} triangles, which does not match its {size} bytes")
    rows = np.frombuffer(content, _TRIANGLE, count, _HEADER)
    with np.errstate(invalid="ignore"):  # check_vertices reports non-finite values
        points = rows["corners"].reshape(-1, 3).astype(np.float64)
    part = _connected(path, points)
    contents = ["attribute bytes"] if rows["attribute"].any() else []
    return _BinaryStl(path, [part], contents, content=content, count=count)


def _read_text(path: Path, content: bytes) -> Document:
    lines = content.splitlines(keepends=True)
    keywords = [b"".join(line.lower().split(maxsplit=1)[:1]) for line in lines]
    chosen = [number for number, keyword in enumerate(keywords) if keyword in _FACET]
    for k, number in enumerate(chosen):
        if keywords[number] != _FACET[k % 5]:
            raise ValueError(f"line {number + 1} does not begin with {_FACET[k % 5].decode()!r}")
    if len(chosen) % 5:
        raise ValueError("it ends within a facet")
    facets, corners = chosen[::5], [number for k, number in enumerate(chosen) if 0 < k % 5 < 4]
    points = numbers(path, [tuple(lines[number].split()) for number in corners], 1)
    normals = numbers(path, [tuple(lines[number].split()) for number in facets], 2)
    solids = [lines[number] for number, keyword in enumerate(keywords) if keyword == b"solid"]
    contents = ["names of solids"] if any(len(line.split()) > 1 for line in solids) else []
    parts = [_connected(path, points)]
    return _TextStl(
        path, parts, contents, lines=lines, facets=facets, corners=corners, normals=normals
    )


def _connected(path: Path, points: Array) -> Part:
    """Merge coincident corners; every three of `points` are the corners of a triangle."""
    if not len(points):
        raise ValueError("it has no triangles")
    check_vertices(path, points)
    order = np.lexsort(points.T)
    is_new = np.append(True, (np.diff(points[order], axis=0) != 0).any(axis=1))
    index = np.empty(len(points), dtype=np.int64)
    index[order] = np.cumsum(is_new) - 1
    return Part("", points[order[is_new]], index.reshape(-1, 3))


def _following(normals: NDArray[np.floating], part: Part, after: Array) -> Array:
    """Return the facet normals, recomputed for triangles that have moved.

    They stay on the side of the surface where they were; a facet without a normal or without area
    is left as it is.
    """
    with np.errstate(invalid="ignore"):
        result = normals.astype(np.float64)
    new, old = (_area_vectors(shape[part.faces]) for shape in (after, part.vertices))
    length = np.linalg.norm(new, axis=1)
    moved = (after != part.vertices).any(axis=1)[part.faces].any(axis=1)
    chosen = moved & (length > 0) & result.any(axis=1)
    new[np.einsum("ij,ij->i", result, old) < 0] *= -1
    result[chosen] = new[chosen] / length[chosen, None]
    return result


def _area_vectors(corners: Array) -> Array:
    """Return a normal of each triangle, of length twice its area."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
