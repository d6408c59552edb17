"""Mesh files as rows on demand: nothing of them stays in memory."""

from __future__ import annotations

import mmap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyListProperty

from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats import ply, stl
from meshlab_spectral.formats.document import Array, Indices
from meshlab_spectral.tiles.bounds import UntiledError

# Called with the current stage and the fraction of it that is done.
StageCallback = Callable[[str, float | None], object]

CHUNK = 1 << 18  # rows that are handled at once
_HEAD = 1 << 20  # bytes in which a header ends
_Rows = np.ndarray[Any, Any]


@dataclass(kw_only=True)
class MeshRows:
    """A mesh file: points, and triangles of their numbers.

    In a PLY file the points are the vertices, in an STL file the corners of all facets: those at
    one position are one vertex.
    """

    path: Path
    points: int
    faces: int
    is_joined_by_position: bool
    block: _Rows  # of the rows that hold the points
    begin: int  # byte offset of that block
    header: bytes = b""
    face_rows: _Rows | None = None
    corners: str = ""  # name of the column of the faces
    normals: bool = False  # whether vertices have some
    quality: str = ""  # name of the column, if any
    flags: tuple[bool, bool] = (False, False)  # whether vertices, and faces, may be selected
    is_single: bool = True  # whether coordinates are single precision

    @property
    def vertices(self) -> int:
        """The number of vertices, estimated for an STL file: half as many as faces."""
        return self.faces // 2 if self.is_joined_by_position else self.points

    def positions(self, numbers: Indices | slice) -> Array:
        """Return the positions of points, k x 3, column by column in memory."""
        if self.is_joined_by_position:
            if isinstance(numbers, slice):
                numbers = np.arange(numbers.start, min(numbers.stop, self.points))
            return self.block["corners"][numbers // 3, numbers % 3].astype(np.float64, order="F")
        return self.columns(numbers, *ply.AXES)

    def columns(self, numbers: Indices | slice, *names: str) -> Array:
        """Return columns of the rows of vertices."""
        rows = self.block[numbers]
        return np.array([rows[name] for name in names], np.float64).T

    def gathered(self, numbers: Indices, *names: str) -> Array:
        """Return columns of many points, by default their positions, a chunk at a time."""
        table = np.empty((len(numbers), len(names) or 3))
        for i, j in chunks(len(numbers)):
            part = numbers[i:j]
            table[i:j] = self.columns(part, *names) if names else self.positions(part)
            self.forget()
        return table

    def triangles(self, begin: int, end: int) -> Indices:
        """Return the points of triangles, k x 3."""
        if self.face_rows is None:
            return np.arange(3 * begin, 3 * end).reshape(-1, 3)
        rows = self.face_rows[begin:end]
        if (rows[f"{self.corners}\n"] != 3).any():
            raise UntiledError(
                f"{self.path.name} has polygons: split them into triangles first (in MeshLab: "
                "Filters > Remeshing > Turn into a Pure-Triangular mesh)"
            )
        found = rows[self.corners].astype(np.int64)
        if found.size and not 0 <= found.min() <= found.max() < self.points:
            raise MeshFileError(f"{self.path} has faces of vertices that it lacks", "damaged")
        return found

    def corners_of(self, F: Indices) -> list[Array]:
        """Return the positions of the first, second and third corners of triangles."""
        return [self.positions(F[:, k]) for k in range(3)]

    def selected_faces(self, begin: int, end: int) -> NDArray[np.bool_]:
        """Return which triangles are selected."""
        assert self.face_rows is not None
        return (self.face_rows["flags"][begin:end].astype(np.int64) & ply.SELECTED) > 0

    def forget(self) -> None:
        """Give the pages of the file back: they would count as memory of this process."""
        if not hasattr(mmap, "MADV_DONTNEED"):
            return
        for rows in (self.block, self.face_rows):
            if isinstance(rows, np.memmap) and len(rows):
                rows._mmap.madvise(mmap.MADV_DONTNEED)  # type: ignore[attr-defined]


def chunks(count: int, size: int = CHUNK) -> Iterator[tuple[int, int]]:
    """Yield the begin and the end of consecutive chunks of rows."""
    return ((i, min(i + size, count)) for i in range(0, count, size))


def open_rows(path: Path) -> MeshRows:
    """Open a binary PLY or STL file; raise UntiledError if it is neither."""
    ending = path.suffix.lower()
    try:
        if ending == ".ply":
            return _open_ply(path)
        if ending == ".stl":
            return _open_stl(path)
    except (ValueError, LookupError, TypeError, OSError) as error:
        raise UntiledError(f"{path.name} cannot be read in parts ({error})") from error
    raise UntiledError(f"{path.name} is neither PLY nor STL: convert it to binary PLY first")


def _open_stl(path: Path) -> MeshRows:
    size = path.stat().st_size
    with path.open("rb") as file:
        count = int.from_bytes(file.read(stl.HEADER)[-4:], "little")
    if size != stl.HEADER + count * stl.TRIANGLE.itemsize or not count:
        raise UntiledError(f"{path.name} is no binary STL file: convert it to binary PLY first")
    block = np.memmap(path, stl.TRIANGLE, "r", stl.HEADER, count)
    return MeshRows(
        path=path,
        points=3 * count,
        faces=count,
        is_joined_by_position=True,
        block=block,
        begin=stl.HEADER,
    )


def _open_ply(path: Path) -> MeshRows:
    with path.open("rb") as file:
        content = file.read(_HEAD)
    found, counts, header = ply.read_header(content)
    if found.text:
        raise UntiledError(f"{path.name} is text: convert it to binary PLY first")
    names = [one.name for one in found]
    if "face" not in names or not counts["face"]:
        raise UntiledError(f"{path.name} has no element with faces: convert it first")
    at, maps, begin = len(header), dict[str, _Rows](), 0
    for element in found:
        if element.name == "vertex":
            begin = at
        row = _row_type(path, at, element, found.byte_order)
        maps[element.name] = np.memmap(path, row, "r", at, counts[element.name])
        at += maps[element.name].nbytes
        if {"vertex", "face"} <= maps.keys():
            break
    vertex, face = found["vertex"], found["face"]
    if not ply.has_floats(vertex, *ply.AXES):
        raise UntiledError(f"{path.name} has no x, y and z as floating-point numbers: convert it")
    corners = next(name for name in ply.CORNERS if name in face)
    if maps["face"].dtype[corners].shape != (3,):
        raise UntiledError(f"{path.name} has polygons: split them into triangles first")
    values = [name for name in ("quality", "confidence") if ply.has_floats(vertex, name)]
    return MeshRows(
        path=path,
        points=counts["vertex"],
        faces=counts["face"],
        is_joined_by_position=False,
        block=maps["vertex"],
        begin=begin,
        header=header,
        face_rows=maps["face"],
        corners=corners,
        normals=ply.has_floats(vertex, *ply.NORMALS),
        quality=values[0] if values else "",
        flags=("flags" in vertex, "flags" in face),
        is_single=any(vertex.ply_property(name).val_dtype == "f4" for name in ply.AXES),
    )


def _row_type(path: Path, begin: int, element: PlyElement, order: PlyData) -> np.dtype[Any]:
    """Return the type of the rows of an element, whose lists are as long as in the first row."""
    fields = list[Any]()
    for one in element.properties:
        shape: tuple[int, ...] = ()
        if isinstance(one, PlyListProperty):
            if element.name != "face":
                raise UntiledError(f"{path.name} has lists in its {element.name} element")
            fields.append((f"{one.name}\n", order + one.len_dtype))
            before = np.dtype(fields)
            with path.open("rb") as file:
                file.seek(begin)
                row = np.frombuffer(file.read(before.itemsize), before)
            shape = (int(row[f"{one.name}\n"][0]),)
        fields.append((one.name, order + one.val_dtype, shape))
    return np.dtype(fields)
