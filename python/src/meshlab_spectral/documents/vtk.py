"""VTK files, read and written with PyVista: legacy .vtk, and XML .vtp and .vtu.

All arrays are kept, but VTK writes its own version of the format, without comments and with no
compression but zlib. Legacy text becomes binary: VTK would write only six digits.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.documents.digits import rounding_told, widening_warnings
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
from meshlab_spectral.documents.polygons import strip_triangles, triangles
from meshlab_spectral.extras import check_extras

_LARGEST_RATIO = 100  # of counts to bytes; zlib packs fewer than 86 points into a byte
_COUNTS = re.compile(rb'(?:NumberOf\w+="|\n(?:POINTS|CELLS|POLYGONS|LINES|VERTICES)\s+)(-?\d+)')
_TEXT = re.compile(rb'<Points>\s*<DataArray[^>]*format="ascii"')
_OTHERS, _STRIP, _POLYGONS = (0, 1, 2, 3, 4), 6, (5, 7, 9)  # VTK cell types
_EXTRACT = "extract its surface first (in ParaView: Filters > Extract Surface), and save it as .vtp"


def read(path: Path) -> Document:
    """Read a mesh of points and flat cells; see `open_document`."""
    check_extras("formats")
    import pyvista

    try:
        counts = [int(count) for count in _COUNTS.findall(path.read_bytes())]
        if counts and not 0 <= min(counts) <= max(counts) <= _LARGEST_RATIO * path.stat().st_size:
            raise ValueError(f"it claims {counts} points and cells")
        with pyvista.vtk_verbosity("off"), pyvista.VtkErrorCatcher(send_to_logging=False) as caught:
            reader = pyvista.get_reader(path).reader
            reader.Update()
            (reader.GetOutputDataObject(0) or pyvista.PolyData()).CheckAttributes()
        for event in caught.events:
            raise ValueError(event.alert)
        return _document(path, pyvista.wrap(reader.GetOutputDataObject(0)))
    except (ValueError, TypeError, LookupError, RuntimeError, MemoryError, AttributeError) as error:
        raise unreadable(path, f"{error!s:.300}") from error


@dataclass(kw_only=True)
class _VtkDocument(Document):
    mesh: Any
    owners: Indices  # the cell of each triangle

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        before, faces, after = self.parts[0].vertices, self.parts[0].faces, moved[0]
        if np.array_equal(before, after):
            target.write_bytes(self.path.read_bytes())
            return []
        mesh = self.mesh.copy()
        told = None if mesh.points.dtype == np.float64 else rounding_told(before, after)
        mesh.points = after.astype(np.result_type(mesh.points, "f8" if told else "f4"))
        for normals in _normals(mesh.point_data):
            normals[:] = following_normals(before, after, faces, np.array(normals))
        for normals in _normals(mesh.cell_data):
            old, new = (_areas(P[faces], self.owners, normals.shape) for P in (before, after))
            side = np.sign((old * normals).sum(axis=1, keepdims=True))  # normals stay on their side
            length = np.linalg.norm(new, axis=1, keepdims=True) * side
            turned = (old != new).any(axis=1) & (length[:, 0] != 0)
            normals[turned] = new[turned] / length[turned]
        mesh.save(target, binary=not _TEXT.search(self.path.read_bytes()))
        return widening_warnings(told)


def _areas(P: Array, owners: Indices, shape: tuple[int, ...]) -> Array:
    """Return the vector areas of cells, from the corners of their triangles, m x 3 x 3."""
    areas = np.zeros(shape)
    np.add.at(areas, owners, np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]))
    return areas


def _normals(data: Any) -> list[Any]:
    names = {data.active_normals_name, "Normals"} & set(data.keys())
    return [data[name] for name in names if data[name].shape[1:] == (3,)]


def _document(path: Path, mesh: Any) -> Document:
    if type(mesh).__name__ not in ("PolyData", "UnstructuredGrid"):
        raise unsupported(path, f"holds {type(mesh).__name__}", _EXTRACT)
    vertices = np.array(mesh.points, dtype=np.float64)
    check_vertices(path, vertices)
    grid = mesh if hasattr(mesh, "celltypes") else mesh.cast_to_unstructured_grid()
    faces, owners = _surface(path, grid, vertices)
    if not len(faces):
        raise unsupported(path, "holds no polygons and no strips", "name a file with a surface")
    scalars = mesh.point_data.active_scalars
    quality = scalars.astype(np.float64) if np.ndim(scalars) == 1 else None
    contents = [f"array {name}" for name in mesh.array_names]
    contents += ["points and lines"] * bool(np.isin(grid.celltypes, _OTHERS).any())
    return _VtkDocument(
        path, [Part("", vertices, faces, quality)], contents, mesh=mesh, owners=owners
    )


def _surface(path: Path, grid: Any, vertices: Array) -> tuple[Indices, Indices]:
    """Return the triangles of polygons and strips, m x 3, and the cell of each."""
    from pyvista import convert_array

    corners = convert_array(grid.GetCells().GetConnectivityArray()).astype(np.int64)
    sizes, types = np.diff(convert_array(grid.GetCells().GetOffsetsArray())), grid.celltypes
    if not np.isin(types, [*_OTHERS, _STRIP, *_POLYGONS]).all():
        raise unsupported(path, f"has volume or curved cells (VTK's type {types.max()})", _EXTRACT)
    if ((corners < 0) | (corners >= len(vertices))).any():
        raise ValueError(f"its cells have corners that are not among its {len(vertices)} points")
    polygons, strips = np.isin(types, _POLYGONS), np.flatnonzero(types == _STRIP)
    faces = [triangles(corners[np.repeat(polygons, sizes)], sizes[polygons], vertices)]
    joined, ends = corners[np.repeat(types == _STRIP, sizes)], np.cumsum(sizes[strips])
    faces.append(strip_triangles(np.insert(joined, ends, -1)))
    cells = np.concatenate([np.flatnonzero(polygons), strips])
    return np.concatenate(faces), np.repeat(cells, np.maximum(sizes[cells] - 2, 0))
