"""Binary PLY files of triangles, in blocks of rows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import MeshFileError, UntiledError
from meshlab_spectral.formats.document import Array, Indices
from meshlab_spectral.formats.ply import (
    AXES,
    CORNERS,
    NORMALS,
    Columns,
    has_floats,
    is_selected,
    quality_of,
    widened,
    with_columns,
)
from meshlab_spectral.formats.ply_elements import read_header, row_type
from meshlab_spectral.formats.rows import Between, MeshRows, Rows, forget

_HEAD = 1 << 20  # bytes in which a header ends


@dataclass(kw_only=True)
class _PlyRows(MeshRows):
    header: bytes
    face_rows: Rows
    corners: str  # the name of the column of the faces
    names: dict[str, tuple[str, ...]]  # the columns of `kinds`

    def columns(self, numbers: Indices | slice, kind: str = "positions") -> Array:
        rows = self.block[numbers]
        return np.array([rows[name] for name in self.names[kind]], np.float64).T

    def triangles(self, begin: int, end: int) -> Indices:
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

    def selected(self, numbers: Indices | slice) -> NDArray[np.bool_]:
        return is_selected(self.block[numbers]["flags"])

    def selected_faces(self, begin: int, end: int) -> NDArray[np.bool_]:
        return is_selected(self.face_rows["flags"][begin:end])

    def widened_header(self, is_wide: bool) -> tuple[bytes, int]:
        return widened(self.header) if is_wide else self.header, len(self.header)

    def written(
        self, begin: int, end: int, moved: Between, normals: Between, is_wide: bool
    ) -> Rows:
        columns: Columns = {AXES: moved(begin, end)}
        if "normals" in self.kinds:
            columns[NORMALS] = normals(begin, end)
        order = self.block.dtype["x"].str[0]
        return with_columns(self.block[begin:end], columns, order if is_wide else None)

    def forget(self) -> None:
        super().forget()
        forget(self.face_rows)


def open_rows(path: Path) -> MeshRows:
    """Open a binary PLY file of triangles; raise UntiledError if it is none."""
    with path.open("rb") as file:
        content = file.read(_HEAD)
    found, counts, header = read_header(content)
    if found.text:
        raise UntiledError(f"{path.name} is text: convert it to binary PLY first")
    if "face" not in found or not counts["face"]:
        raise UntiledError(f"{path.name} has no element with faces: convert it first")
    at, maps, begin = len(header), dict[str, Rows](), 0
    for element in found:
        if element.name == "vertex":
            begin = at
        type_ = row_type(element, found.byte_order, partial(_first_size, path, element.name, at))
        maps[element.name] = np.memmap(path, type_, "r", at, counts[element.name])
        at += maps[element.name].nbytes
        if {"vertex", "face"} <= maps.keys():
            break
    vertex, face = found["vertex"], found["face"]
    if not has_floats(vertex, *AXES):
        raise UntiledError(f"{path.name} has no x, y and z as floating-point numbers: convert it")
    corners = next(name for name in CORNERS if name in face)
    if maps["face"].dtype[corners].shape != (3,):
        raise UntiledError(f"{path.name} has polygons: split them into triangles first")
    names: dict[str, tuple[str, ...]] = {"positions": AXES, "normals": NORMALS}
    names["quality"] = (quality_of(vertex),)
    names = {kind: own for kind, own in names.items() if has_floats(vertex, *own)}
    return _PlyRows(
        path=path,
        points=counts["vertex"],
        faces=counts["face"],
        block=maps["vertex"],
        begin=begin,
        kinds=frozenset(names),
        flags=("flags" in vertex, "flags" in face),
        is_single=any(vertex.ply_property(name).val_dtype == "f4" for name in AXES),
        header=header,
        face_rows=maps["face"],
        corners=corners,
        names=names,
    )


def _first_size(path: Path, element: str, begin: int, fields: Any) -> int:
    """Return the size of the list in the first row of an element, which begins at a byte offset."""
    if element != "face":
        raise UntiledError(f"{path.name} has lists in its {element} element")
    before = np.dtype(fields)
    with path.open("rb") as file:
        file.seek(begin)
        row = np.frombuffer(file.read(before.itemsize), before)
    return int(row[fields[-1][0]][0])
