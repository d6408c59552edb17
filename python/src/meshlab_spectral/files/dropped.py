"""Vertices that MeshLab drops with their faces, without a word: those that are NaN or infinite."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.claims import STL_HEADER, stl_triangles
from meshlab_spectral.files.ply_header import Element, PlyHeader, read_ply_header

Array = NDArray[np.float64]

_NONE: Array = np.zeros((0, 3))
_STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])


def check_nothing_dropped(source: Path, vertices: int, faces: int) -> None:
    """Raise MeshFileError, which names the first, when MeshLab has dropped vertices of a file.

    Coordinates are looked at only when a PLY, OBJ, OFF or STL file holds more than was read.

    Parameters
    ----------
    source
        The file.
    vertices, faces
        How many MeshLab has read from it.
    """
    ending = source.suffix.lower()
    try:
        if ending == ".ply":
            V = _ply_vertices(source, vertices)
        elif ending == ".obj":
            V = _obj_vertices(source, vertices)
        elif ending == ".off":
            V = _off_vertices(source, vertices)
        else:
            V = _stl_vertices(source, faces) if ending == ".stl" else _NONE
    except ValueError:  # a variant that MeshLab knows, but this module does not
        return
    with np.errstate(over="ignore"):  # a double may be too large for the file's type
        lost = ~np.isfinite(V.astype(np.float32)).all(axis=1)
    if not lost.any():
        return
    first = int(np.argmax(lost))
    which = f"a corner of triangle {first // 3}" if ending == ".stl" else f"vertex {first}"
    x, y, z = V[first]
    raise MeshFileError(
        f"{source}: {which} is at {x:g} {y:g} {z:g}, which is not finite or too large: correct it, "
        "or open and save the file in MeshLab, which deletes such vertices with their faces"
    )


def _coordinates(lines: Iterable[bytes], columns: tuple[int, int, int] = (0, 1, 2)) -> Array:
    """Read coordinates from lines of text; raises ValueError where there are none."""
    rows = [line.split() for line in lines]
    if any(len(row) <= max(columns) for row in rows):
        raise ValueError("a line without coordinates")
    return np.array([[row[c] for c in columns] for row in rows], dtype=np.float64).reshape(-1, 3)


def _ply_vertices(source: Path, read: int) -> Array:
    header = read_ply_header(source)
    names = [] if header is None else [element.name for element in header.elements]
    if header is None or "vertex" not in names:
        return _NONE
    index = names.index("vertex")
    before, vertex = header.elements[:index], header.elements[index]
    if vertex.count == read:
        return _NONE
    columns = [one.name for one in vertex.properties]
    x, y, z = (columns.index(name) for name in "xyz")
    if any(one.is_list for one in vertex.properties[: max(x, y, z)]):
        raise ValueError("a list before the coordinates")
    if header.format_ == "ascii":
        with source.open("rb") as file:
            file.seek(header.size)
            begin = sum(element.count for element in before)
            lines = itertools.islice(file, begin, begin + vertex.count)
            return _coordinates(lines, (x, y, z))
    return _binary_ply_vertices(source, header, before, vertex)


def _binary_ply_vertices(
    source: Path, header: PlyHeader, before: list[Element], vertex: Element
) -> Array:
    if any(one.is_list for element in [*before, vertex] for one in element.properties):
        raise ValueError("lists of unknown length before the coordinates")
    order = ">" if header.format_ == "binary_big_endian" else "<"
    type_ = np.dtype([(one.name, order + one.type_) for one in vertex.properties])
    begin = header.size + sum(element.least_bytes(ascii_=False) for element in before)
    rows = np.fromfile(source, type_, vertex.count, offset=begin)
    return np.column_stack([rows[name] for name in "xyz"]).astype(np.float64)


def _obj_vertices(source: Path, read: int) -> Array:
    def lines() -> Iterator[bytes]:
        with source.open("rb") as file:
            for line in file:
                if line.startswith((b"v ", b"v\t")):
                    yield line

    return _NONE if sum(1 for _ in lines()) == read else _coordinates(lines(), (1, 2, 3))


def _off_vertices(source: Path, read: int) -> Array:
    with source.open("rb") as file:
        lines = (line for line in file if line.strip() and not line.startswith(b"#"))
        first = next(lines, b"").split()
        if first[:1] not in ([b"OFF"], [b"COFF"], [b"NOFF"], [b"STOFF"]):
            raise ValueError("another OFF, or none")
        count = int((first[1:] or next(lines, b"").split() or [b""])[0])
        return _NONE if count == read else _coordinates(itertools.islice(lines, count))


def _stl_vertices(source: Path, read: int) -> Array:
    count = stl_triangles(source)
    if count is not None:
        if count == read:
            return _NONE
        corners = np.fromfile(source, _STL_TRIANGLE, count, offset=STL_HEADER)["corners"]
        return corners.reshape(-1, 3).astype(np.float64)
    with source.open("rb") as file:
        lines = [line for line in file if line.lstrip()[:6].lower() == b"vertex"]
    return _NONE if len(lines) == 3 * read else _coordinates(lines, (1, 2, 3))
