"""VTK files, read and written with PyVista: legacy .vtk, and XML .vtp and .vtu.

In legacy files coordinates and normals are replaced in place. XML keeps all arrays, but VTK writes
its own version of the format, without comments and with no compression but zlib.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.extras import check_extras
from meshlab_spectral.formats.budget import Budget, guarded
from meshlab_spectral.formats.causes import EndsEarlyError, unreadable, unsupported
from meshlab_spectral.formats.digits import (
    DOUBLE,
    SINGLE,
    digits_for,
    rounding_loss,
    widening_warnings,
)
from meshlab_spectral.formats.document import Array, Document, Indices, Part, check_vertices
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.normals import following_face_normals, following_normals
from meshlab_spectral.formats.polygons import strip_triangles, triangles
from meshlab_spectral.formats.text import Change, numbers_from, write_patched
from meshlab_spectral.warned import Warned

_TAG_BYTES = 800  # of what VTK makes of a tag
_OF_VTK = 256 << 20  # bytes of its own, such as tables of threads
_LONGEST = 18  # digits of a count
# Numbers from which VTK allocates: attributes of its XML; in legacy files those after keywords, and
# the columns and rows of arrays. After the name of a scalar's LOOKUP_TABLE there are values.
_ATTRIBUTES = re.compile(rb"NumberOf\w+\s*=\s*[\"']\s*([-+]?\d+)")
_COUNTS = re.compile(
    rb"[\r\n][ \t]*(?=[^\s\d.+-])"
    rb"(?i:SCALARS\s+\S+\s+\S+(?:\s+([-+]?\d+))?(?:\s+LOOKUP_TABLE\s+\S+)?"
    rb"|(?:POINTS|CELLS|CELL_TYPES|POLYGONS|TRIANGLE_STRIPS|LINES|VERTICES|POINT_DATA|CELL_DATA"
    rb"|(?:FIELD|COLOR_SCALARS|LOOKUP_TABLE|TEXTURE_COORDINATES)\s+\S+)\s+([-+]?\d+)"
    rb"|\S+[ \t]+(\d+)[ \t]+(\d+)[ \t]+[a-z]\w*[ \t]*[\r\n])"
)
_TEXT = re.compile(rb'<Points>\s*<DataArray[^>]*format="ascii"')
# Legacy text, after two lines of head and title; then its points, and arrays.
_LEGACY = re.compile(rb"#[^\n]*\n[^\n]*\n\s*ASCII\s", re.IGNORECASE)
_HEAD = b"# vtk DataFile"
_BINARY = re.compile(rb"#[^\n]*\n[^\n]*\n\s*BINARY\s", re.IGNORECASE)
_LAST_WORD = re.compile(rb"(?i)(POINTS[ \t]+\d+[ \t]+)float([ \t]*[\r\n]+)\Z")
_POINTS = re.compile(rb"(?mi)^[ \t]*POINTS[ \t]+(\d+)[ \t]+(\w+)[ \t]*[\r\n]\s*")
_CELLS = re.compile(rb"(?mi)^[ \t]*(?:CELLS|POLYGONS|TRIANGLE_STRIPS|LINES|VERTICES)[ \t]")
_SECTION = re.compile(rb"(?mi)^[ \t]*(POINT_DATA|CELL_DATA)[ \t]+(\d+)")
_ARRAY = re.compile(
    rb"(?mi)^[ \t]*(?:SCALARS[ \t]+\S+[ \t]+\w+(?:[ \t]+(?P<width>\d+))?\s+LOOKUP_TABLE[ \t]+\S+"
    rb"|(?:TEXTURE_COORDINATES[ \t]+\S+[ \t]+(?P<texture>\d+)[ \t]+\w+)"
    rb"|COLOR_SCALARS[ \t]+\S+[ \t]+(?P<colours>\d+)"
    rb"|(?P<three>NORMALS|VECTORS)[ \t]+\S+[ \t]+\w+"
    rb"|\S+[ \t]+(?P<columns>\d+)[ \t]+(?P<rows>\d+)[ \t]+[a-z]\w*)[ \t]*[\r\n]"
)
_SHORT = re.compile("error reading (?:binary|ascii)|premature|end of file|EOF", re.IGNORECASE)
_OTHERS, _STRIP, _POLYGONS = (0, 1, 2, 3, 4), 6, (5, 7, 9)  # VTK cell types
_EXTRACT = "extract its surface first (in ParaView: Filters > Extract Surface), and save it as .vtp"


def read(path: Path) -> Document:
    """Read a mesh of points and flat cells; see `open_document`."""
    check_extras("formats")
    import pyvista

    try:
        content = path.read_bytes()
        budget = Budget(path, len(content))
        _check_counts(content, budget)
        _check_text(content)
        del content
        with (
            pyvista.vtk_verbosity("off"),
            pyvista.VtkErrorCatcher(send_to_logging=False) as caught,
            guarded(budget, _OF_VTK),
        ):
            reader = pyvista.get_reader(path).reader
            reader.Update()
            (reader.GetOutputDataObject(0) or pyvista.PolyData()).CheckAttributes()
        for event in caught.events:
            raise _fault(event.alert, path)
        return _document(path, pyvista.wrap(reader.GetOutputDataObject(0)))
    except (ValueError, TypeError, LookupError, RuntimeError, AttributeError) as error:
        raise unreadable(path, type(error)(f"{error!s:.300}")) from error


def _check_counts(content: bytes, budget: Budget) -> None:
    """Raise MeshFileError if a file claims more than a file of its size may have."""
    is_legacy = content.startswith(b"#")
    for match in (_COUNTS if is_legacy else _ATTRIBUTES).finditer(content):
        words = [word for word in match.groups() if word]
        number = math.prod(int(word[:_LONGEST]) for word in words)
        if number < 0:
            raise ValueError(f"it claims {number} points, cells or numbers")
        budget.take(24 * number, f"it claims {number} points, cells or numbers")  # three doubles
    if not is_legacy:
        budget.take(_TAG_BYTES * content.count(b"<"), "its XML")


def _fault(alert: str, path: Path) -> ValueError:
    """Return the error for what VTK tells: binary data, or the last line of a text, may be cut."""
    is_text = "ascii" in alert and path.read_bytes().endswith((b"\n", b"\r"))
    is_cut = _SHORT.search(alert) and not is_text
    return EndsEarlyError(alert) if is_cut else ValueError(alert)


def _check_text(content: bytes) -> None:
    """Raise ValueError if a legacy text lacks numbers: VTK would make some up."""
    head = _LEGACY.match(content)
    points = _POINTS.search(content, head.end()) if head else None
    if not points:
        return
    numbers_from(content, points.end(), 3 * int(points[1]), "its points")
    if content.endswith((b"\n", b"\r")):
        return
    if not _CELLS.search(content, points.end()):
        raise EndsEarlyError("it ends after its points")
    arrays = list(_ARRAY.finditer(content, points.end()))
    sections = _SECTION.findall(content, points.end(), arrays[-1].start()) if arrays else []
    if sections:
        last = arrays[-1]
        widths = (last[name] for name in ("width", "texture", "colours", "columns"))
        width = 3 if last["three"] else int(next(filter(None, widths), 1))
        count = int(last["rows"] or sections[-1][1])
        numbers_from(content, last.end(), count * width, "its last array")


@dataclass(kw_only=True)
class _VtkDocument(Document):
    mesh: Any
    owners: Indices  # the cell of each triangle

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        before, faces, after = self.parts[0].vertices, self.parts[0].faces, moved[0]
        mesh = self.mesh.copy()
        loss = None if mesh.points.dtype == np.float64 else rounding_loss(before, after)
        if mesh.points.dtype.kind != "f":
            loss = "the file has integers"
        mesh.points = after.astype(np.result_type(mesh.points, "f8" if loss else "f4"))
        for normals in _normals(mesh.point_data):
            normals[:] = following_normals(before, after, faces, np.array(normals))
        for normals in _normals(mesh.cell_data):
            old = np.array(normals, np.float64)
            normals[:] = following_face_normals(before, after, faces, old, self.owners)
        content = self.path.read_bytes()
        changes, text = _changes_of_text(content, self.mesh, mesh, bool(loss))
        if changes:
            is_double = mesh.points.dtype == np.float64
            changes[0] = (*changes[0][:-1], DOUBLE if is_double else digits_for(before, after))
            with target.open("wb") as file:
                write_patched(file, text, changes)
        elif (patched := _patched_binary(content, self.mesh, mesh)) is not None:
            target.write_bytes(patched)
        else:
            mesh.save(target, binary=not _TEXT.search(content))
            _keep_title(content, target)
        return widening_warnings(loss)


def _changes_of_text(
    content: bytes, before: Any, after: Any, is_wide: bool
) -> tuple[list[Change], bytes]:
    """Return the changes of a legacy text, first those of its points, and the text to change.

    In that, points are declared as double if `is_wide`. There are no changes if it is no such text.
    """
    head = _LEGACY.match(content)
    points = _POINTS.search(content, head.end()) if head else None
    if not points:
        return [], content
    if is_wide:
        content = content[: points.start(2)] + b"double" + content[points.end(2) :]
        points = _POINTS.search(content, points.start())
        assert points is not None
    changes = [_change(points.end(), before.points, after.points, SINGLE)]
    for association, keyword in (("point_data", b"POINT_DATA"), ("cell_data", b"CELL_DATA")):
        old, new = (getattr(mesh, association) for mesh in (before, after))
        for name in _names_of_normals(old):
            offset = _offset_of_array(content, points.end(), keyword, name)
            if offset is not None:
                changes.append(_change(offset, old[name], new[name], SINGLE))
    return changes, content


def _patched_binary(content: bytes, before: Any, after: Any) -> bytes | None:
    """Return binary legacy data with the bytes of points and normals replaced.

    None if it is no such data, or an array is not found in it just once.
    """
    if not _BINARY.match(content):
        return None
    pairs = [(before.points, after.points)]
    for association in ("point_data", "cell_data"):
        old, new = (getattr(mesh, association) for mesh in (before, after))
        pairs += [(old[name], new[name]) for name in _names_of_normals(old)]
    for number, (one, other) in enumerate(pairs):
        old, new = (np.asarray(a).astype(a.dtype.newbyteorder(">")).tobytes() for a in (one, other))
        at = content.find(old)
        if at < 0 or content.find(old, at + 1) >= 0:
            return None
        head = content[:at]
        if len(new) != len(old):  # points only
            head, found = _LAST_WORD.subn(rb"\1double\2", head)
            if number or not found:
                return None
        content = head + new + content[at + len(old) :]
    return content


def _keep_title(content: bytes, target: Path) -> None:
    """Give a file that VTK has written the second line of the one that was read."""
    if content.startswith(_HEAD):
        first, _, rest = target.read_bytes().partition(b"\n")
        lines = [first, content.split(b"\n", 2)[1], rest.partition(b"\n")[2]]
        target.write_bytes(b"\n".join(lines))


def _change(offset: int, before: Any, after: Any, digits: int) -> Change:
    """Return the change of all numbers of an array, which follow each other from an offset on."""
    old, new = (np.asarray(one, np.float64).reshape(1, -1) for one in (before, after))
    return np.array([offset]), 0, old, new, digits


def _offset_of_array(content: bytes, begin: int, section: bytes, name: str) -> int | None:
    """Return where the numbers of a vector array begin in legacy text; None if it is not found."""
    encoded = re.escape(name.replace("%", "%25").replace(" ", "%20").encode())
    found = re.compile(
        rb"(?mi)^[ \t]*(?:(?:(?:NORMALS|VECTORS)[ \t]+" + encoded + rb"[ \t]+\w+"
        rb"|" + encoded + rb"[ \t]+3[ \t]+\d+[ \t]+\w+)[ \t]*[\r\n]\s*"
        rb"|(POINT_DATA|CELL_DATA)[ \t]+\d)"
    )
    current = b""
    for match in found.finditer(content, begin):
        if match[1]:
            current = match[1].upper()
        elif current == section:
            return match.end()
    return None


def _normals(data: Any) -> list[Any]:
    return [data[name] for name in _names_of_normals(data)]


def _names_of_normals(data: Any) -> list[str]:
    names = {data.active_normals_name, "Normals"} & set(data.keys())
    return [name for name in sorted(names) if data[name].shape[1:] == (3,)]


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
    contents = [f"array {shown(name)}" for name in mesh.array_names]
    contents += ["points and lines"] * bool(np.isin(np.asarray(grid.celltypes), _OTHERS).any())
    return _VtkDocument(
        path, [Part("", vertices, faces, quality)], contents, mesh=mesh, owners=owners
    )


def _surface(path: Path, grid: Any, vertices: Array) -> tuple[Indices, Indices]:
    """Return the triangles of polygons and strips, m x 3, and the cell of each."""
    from pyvista import convert_array

    if not grid.GetNumberOfCells():
        return np.zeros((0, 3), np.int64), np.zeros(0, np.int64)
    corners = convert_array(grid.GetCells().GetConnectivityArray()).astype(np.int64)
    sizes = np.diff(convert_array(grid.GetCells().GetOffsetsArray()))
    types = np.asarray(grid.celltypes, dtype=np.int64)
    others = set(np.unique(types).tolist()) - {*_OTHERS, _STRIP, *_POLYGONS}
    if others:
        found = ", ".join(map(str, sorted(others)))
        raise unsupported(path, f"has volume or curved cells (VTK's type {found})", _EXTRACT)
    if ((corners < 0) | (corners >= len(vertices))).any():
        raise ValueError(f"its cells have corners that are not among its {len(vertices)} points")
    polygons, strips = np.isin(types, _POLYGONS), np.flatnonzero(types == _STRIP)
    faces = [triangles(corners[np.repeat(polygons, sizes)], sizes[polygons], vertices)]
    joined, ends = corners[np.repeat(types == _STRIP, sizes)], np.cumsum(sizes[strips])
    faces.append(strip_triangles(np.insert(joined, ends, -1)))
    cells = np.concatenate([np.flatnonzero(polygons), strips])
    return np.concatenate(faces), np.repeat(cells, np.maximum(sizes[cells] - 2, 0))
