"""Surfaces of brains: GIFTI (.gii), and FreeSurfer's geometry (lh.pial, lh.white).

The coordinates are replaced where they lie; every other byte stays, such as labels, metadata, and
what FreeSurfer writes behind the triangles.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.documents.digits import SINGLE, digits_for, precision_warning
from meshlab_spectral.documents.document import (
    Array,
    Document,
    Indices,
    Part,
    check_indices,
    check_vertices,
    unreadable,
    unsupported,
)
from meshlab_spectral.documents.normals import following_normals
from meshlab_spectral.documents.vtk import (
    Edit,
    Element,
    children,
    edited,
    elements,
    floats,
    from_base64,
    unzipped,
    with_numbers,
)
from meshlab_spectral.errors import MeshFileError

TRIANGLES = b"\xff\xff\xfe"  # how a surface of FreeSurfer begins
_QUADRILATERALS = (b"\xff\xff\xff", b"\xff\xff\xfd")
_CURV = b"\xff\xff\xff"


def read(path: Path) -> Document:
    """Read a surface of GIFTI or FreeSurfer.

    The vertices are the coordinates that are stored. The matrices of GIFTI, which lead from there
    to other spaces, are not applied, nor is FreeSurfer's volume geometry: nibabel and Connectome
    Workbench show the stored coordinates, too, and filters commute with rigid motions.

    Raises
    ------
    MeshFileError
        When it is damaged, or holds no surface of triangles.
    """
    data = path.read_bytes()
    try:
        if data.startswith(_QUADRILATERALS):
            raise _not_triangles(path, data)
        if data.startswith(TRIANGLES):
            return _read_free_surfer(path, data)
        if path.suffix.lower() != ".gii":
            raise ValueError("it begins neither as GIFTI nor as a surface of FreeSurfer")
        return _read_gifti(path, data)
    except ValueError as error:
        raise unreadable(path, error) from error


# FreeSurfer.


@dataclass(kw_only=True)
class _FreeSurfer(Document):
    data: bytes
    begin: int  # of the coordinates

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        before, after = self.parts[0].vertices, moved[0]
        coordinates = after.astype(">f4").tobytes()
        end = self.begin + len(coordinates)
        target.write_bytes(self.data[: self.begin] + coordinates + self.data[end:])
        warning = precision_warning(before, after, target.name)
        return [warning] if warning else []


def _read_free_surfer(path: Path, data: bytes) -> Document:
    stamp = data.find(b"\n") + 1
    begin = data.find(b"\n", stamp) + 9  # behind a second line, and two counts
    if not 0 < stamp < begin - 8 or begin > len(data):
        raise ValueError("it ends before its counts")
    n, m = np.frombuffer(data, ">i4", 2, begin - 8).tolist()
    tail = begin + 12 * (n + m)
    if n < 0 or m < 0 or tail > len(data):
        raise ValueError(f"it says {n} vertices and {m} triangles, for {len(data)} bytes")
    with np.errstate(invalid="ignore"):  # what is no number is found when checked
        vertices = np.frombuffer(data, ">f4", 3 * n, begin).reshape(-1, 3).astype(np.float64)
    faces = np.frombuffer(data, ">i4", 3 * m, begin + 12 * n).reshape(-1, 3).astype(np.int64)
    check_vertices(path, vertices)
    check_indices(path, faces, n)
    contents = ["volume geometry"] if tail < len(data) else []
    return _FreeSurfer(
        path=path, parts=[Part("", vertices, faces)], contents=contents, data=data, begin=begin
    )


def _not_triangles(path: Path, data: bytes) -> MeshFileError:
    if data.startswith(_CURV) and len(data) >= 15:
        n, _, values = np.frombuffer(data, ">i4", 3, 3).tolist()
        if len(data) == 15 + 4 * n * values:
            return MeshFileError(
                f"{path} holds no surface, only FreeSurfer's values at {n} vertices (such as "
                "curvature or thickness): name the surface, such as lh.pial or lh.white"
            )
    return unsupported(
        path,
        "is an old surface of FreeSurfer, of quadrilaterals",
        "convert it to triangles with FreeSurfer's mris_convert",
    )


# GIFTI.

_KINDS = {"FLOAT32": "f4", "FLOAT64": "f8", "INT32": "i4", "UINT8": "u1"}
_POINTS, _TRIANGLES = "NIFTI_INTENT_POINTSET", "NIFTI_INTENT_TRIANGLE"
_VECTORS = "NIFTI_INTENT_VECTOR"


@dataclass(frozen=True)
class _Stored:
    """A data array of a GIFTI file."""

    begin: int
    end: int
    kind: np.dtype[Any]
    encoding: str
    order: Any  # "C" or "F"
    rows: int

    def values(self, data: bytes) -> NDArray[Any]:
        """Return its numbers, n x 3."""
        text = data[self.begin : self.end]
        if self.encoding == "ASCII":
            numbers = floats(text)
        else:
            numbers = np.frombuffer(self._decoded(text), self.kind)
        if len(numbers) != 3 * self.rows:
            raise ValueError(f"an array has {len(numbers)} numbers, not {self.rows} x 3")
        with np.errstate(over="ignore", invalid="ignore"):  # what does not fit is found later
            return numbers.astype(self.kind).reshape((self.rows, 3), order=self.order)

    def _decoded(self, text: bytes) -> bytes:
        decoded = from_base64(text)
        if self.encoding == "Base64Binary":
            return decoded
        return unzipped(decoded, 3 * self.rows * self.kind.itemsize)

    def edit(self, data: bytes, before: Array, after: Array) -> Edit:
        """Return what changes in the file when the numbers change."""
        text = data[self.begin : self.end]
        if self.encoding == "ASCII":
            digits = digits_for(before, after) if self.kind.itemsize == 8 else SINGLE
            text = with_numbers(text, before.ravel(self.order), after.ravel(self.order), digits)
        else:
            numbers = after.astype(self.kind).tobytes(self.order)
            compress = self.encoding == "GZipBase64Binary"
            text = base64.b64encode(zlib.compress(numbers) if compress else numbers)
        return Edit(self.begin, self.end, text)


@dataclass(kw_only=True)
class _Gifti(Document):
    data: bytes
    points: _Stored
    normals: list[_Stored]

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        before, after = self.parts[0].vertices, moved[0]
        warning = None
        if np.array_equal(before, after):
            target.write_bytes(self.data)
        else:
            target.write_bytes(edited(self.data, list(self._edits(before, after))))
            if self.points.kind.itemsize == 4:
                warning = precision_warning(before, after, target.name)
        return [warning] if warning else []

    def _edits(self, before: Array, after: Array) -> Iterator[Edit]:
        yield self.points.edit(self.data, before, after)
        for stored in self.normals:
            old = stored.values(self.data).astype(np.float64)
            new = following_normals(before, after, self.parts[0].faces, old)
            yield stored.edit(self.data, old, new)


def _read_gifti(path: Path, data: bytes) -> Document:
    found = elements(data)
    if found[0].name != "GIFTI":
        raise ValueError(f"it holds {found[0].name}, not GIFTI")
    arrays = children(found, found[0], "DataArray")
    _check_surface(path, [_intent(array) for array in arrays])
    points, corners = (
        _stored(path, found, next(a for a in arrays if _intent(a) == intent))
        for intent in (_POINTS, _TRIANGLES)
    )
    with np.errstate(invalid="ignore"):
        vertices = points.values(data).astype(np.float64)
        faces = corners.values(data).astype(np.int64)
    if points.kind.kind != "f":
        raise ValueError("its points are not real numbers")
    check_vertices(path, vertices)
    check_indices(path, faces, len(vertices))
    vectors = [_stored(path, found, array) for array in arrays if _is_vectors(array, len(vertices))]
    return _Gifti(
        path=path,
        parts=[Part("", vertices, faces)],
        contents=_contents(found),
        data=data,
        points=points,
        normals=[
            v for v in vectors if _are_normals(v.values(data).astype(np.float64), vertices, faces)
        ],
    )


def _intent(array: Element) -> str:
    return array.attributes.get("Intent", "")


def _check_surface(path: Path, intents: list[str]) -> None:
    if _POINTS not in intents and _TRIANGLES not in intents:
        kinds = ", ".join(sorted(set(intents))) or "no data"
        raise MeshFileError(
            f"{path} holds no surface, only values at vertices ({kinds}): name the .surf.gii file "
            "that they belong to"
        )
    for intent, what in ((_POINTS, "points"), (_TRIANGLES, "triangles")):
        if intents.count(intent) != 1:
            raise unsupported(
                path,
                f"holds {intents.count(intent)} arrays of {what}",
                "save each surface, points and triangles together, as a .surf.gii file",
            )


def _contents(found: Sequence[Element]) -> list[str]:
    intents = [_intent(e).removeprefix("NIFTI_INTENT_").lower() for e in found[1:]]
    names = {element.name for element in found}
    shown = {
        "Metadata": "MD" in names,
        "labels": "Label" in names,
        "coordinate systems": "CoordinateSystemTransformMatrix" in names,
    }
    return [
        *(name for name, there in shown.items() if there),
        *(f"{intent} data" for intent in intents if intent not in ("", "pointset", "triangle")),
    ]


def _stored(path: Path, found: Sequence[Element], array: Element) -> _Stored:
    attributes = array.attributes
    kind = attributes.get("DataType", "").removeprefix("NIFTI_TYPE_")
    encoding = attributes.get("Encoding", "")
    if encoding == "ExternalFileBinary":
        raise unsupported(
            path,
            "keeps its numbers in another file",
            "convert it with wb_command -gifti-convert GZIP_BASE64_BINARY",
        )
    if kind not in _KINDS or encoding not in ("ASCII", "Base64Binary", "GZipBase64Binary"):
        raise ValueError(f'an array has the type "{kind}" in the encoding "{encoding}"')
    texts = children(found, array, "Data")
    if len(texts) != 1 or not _has_rows_of_three(array):
        raise ValueError(f"an array of {_intent(array)} has no n x 3 numbers")
    byte_order = ">" if attributes.get("Endian") == "BigEndian" else "<"
    return _Stored(
        texts[0].begin,
        texts[0].end,
        np.dtype(byte_order + _KINDS[kind]),
        encoding,
        "F" if attributes.get("ArrayIndexingOrder") == "ColumnMajorOrder" else "C",
        array.count("Dim0"),
    )


def _has_rows_of_three(array: Element) -> bool:
    dimensions = array.count("Dimensionality"), array.count("Dim1")
    return dimensions == (2, 3) and array.count("Dim0") >= 0


def _is_vectors(array: Element, vertices: int) -> bool:
    return (
        _intent(array) == _VECTORS and _has_rows_of_three(array) and array.count("Dim0") == vertices
    )


def _are_normals(vectors: Array, vertices: Array, faces: Indices) -> bool:
    """Whether vectors at vertices, of which GIFTI does not say more, are normals."""
    P = vertices[faces]
    areas = np.repeat(np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]), 3, axis=0)
    normals = np.column_stack(
        [np.bincount(faces.ravel(), areas[:, c], minlength=len(vertices)) for c in range(3)]
    )
    length = np.linalg.norm(normals, axis=1)
    cosine = np.abs(np.einsum("ij,ij->i", vectors, normals))[length > 0] / length[length > 0]
    is_unit = np.abs(np.linalg.norm(vectors, axis=1) - 1) < 1e-3
    return bool(is_unit.all() and cosine.size and np.median(cosine) > 0.9)
