"""Brain surfaces: GIFTI (.gii) and FreeSurfer geometry (lh.pial, lh.white).

nibabel reads and writes GIFTI. It drops XML comments, keeps one coordinate system per array, and
writes matrices with six decimals. Arrays of numbers as text would also lose digits: they become
binary. FreeSurfer's coordinates are replaced in place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from shutil import copyfile
from typing import Any

import numpy as np

from meshlab_spectral.documents.digits import precision_warnings
from meshlab_spectral.documents.document import (
    Array,
    Document,
    checked_part,
    unreadable,
    unsupported,
)
from meshlab_spectral.documents.normals import following_normals
from meshlab_spectral.errors import MeshFileError, SpectralError
from meshlab_spectral.extras import check_extras

_TRIANGLES = b"\xff\xff\xfe"  # first bytes of a FreeSurfer surface
_TEXT, _BINARY = 1, 2  # encodings of GIFTI
_OTHERS = (b"\xff\xff\xff", b"\xff\xff\xfd")  # quadrilaterals, or values such as curvature


def read(path: Path) -> Document:
    """Read a GIFTI or FreeSurfer surface; see `open_document`.

    Vertices have the stored coordinates, as in nibabel and Connectome Workbench: neither GIFTI's
    matrices, which transform to other spaces, nor FreeSurfer's volume geometry are applied.
    """
    with path.open("rb") as file:
        magic = file.read(3)
    if magic in _OTHERS:
        remedy = "name the surface, such as lh.pial, or convert it with FreeSurfer's mris_convert"
        raise unsupported(path, "holds values or quadrilaterals of FreeSurfer", remedy)
    try:
        if magic == _TRIANGLES:
            return _read_free_surfer(path)
        if path.suffix.lower() != ".gii":
            raise ValueError("it begins neither as GIFTI nor as a surface of FreeSurfer")
        return _read_gifti(path)
    except SpectralError:
        raise
    except Exception as error:  # nibabel raises whatever its parsers do
        raise unreadable(path, error) from error


@dataclass(kw_only=True)
class _FreeSurfer(Document):
    begin: int  # byte offset of the coordinates

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        before, after = self.parts[0].vertices, moved[0]
        copyfile(self.path, target)
        with target.open("r+b") as file:
            file.seek(self.begin)
            file.write(after.astype(">f4").tobytes())
        return precision_warnings(before, after, target.name)


def _read_free_surfer(path: Path) -> Document:
    data = path.read_bytes()
    begin = data.index(b"\n", data.index(b"\n") + 1) + 9  # after two lines and two counts
    n, m = np.frombuffer(data, ">i4", 2, begin - 8).tolist()
    tail = begin + 12 * (n + m)
    if n < 0 or m < 0 or tail > len(data):
        raise ValueError(f"it claims {n} vertices and {m} triangles, in {len(data)} bytes")
    with np.errstate(invalid="ignore"):  # checked_part reports non-finite values
        vertices = np.frombuffer(data, ">f4", 3 * n, begin).reshape(-1, 3).astype(np.float64)
    faces = np.frombuffer(data, ">i4", 3 * m, begin + 12 * n).reshape(-1, 3).astype(np.int64)
    contents = ["volume geometry"] if tail < len(data) else []
    return _FreeSurfer(
        path=path, parts=[checked_part(path, vertices, faces)], contents=contents, begin=begin
    )


@dataclass(kw_only=True)
class _Gifti(Document):
    image: Any  # nibabel.gifti.GiftiImage
    points: Any  # its GiftiDataArray with the coordinates
    vectors: list[Any]  # its arrays of normals

    def save(self, target: Path, moved: Sequence[Array]) -> list[str]:
        (part,), (after,) = self.parts, moved
        if (after == part.vertices).all():
            copyfile(self.path, target)
            return []
        for array in self.vectors:
            normals = array.data.astype(np.float64)
            new = following_normals(part.vertices, after, part.faces, normals)
            array.data = new.astype(array.data.dtype)
        self.points.data = after.astype(self.points.data.dtype)
        for array in self.image.darrays:
            if array.encoding == _TEXT and array.data.dtype.kind == "f":
                array.encoding = _BINARY
        target.write_bytes(self.image.to_bytes(mode="force"))  # force: doubles are allowed, too
        return precision_warnings(part.vertices, after, target.name)


def _read_gifti(path: Path) -> Document:
    check_extras("formats")
    import nibabel

    image: Any = nibabel.gifti.GiftiImage.from_filename(path)
    if image is None:
        raise ValueError("it is XML, but not GIFTI")
    points = image.get_arrays_from_intent("NIFTI_INTENT_POINTSET")
    triangles = image.get_arrays_from_intent("NIFTI_INTENT_TRIANGLE")
    if len(points) != 1 or len(triangles) != 1:
        raise MeshFileError(
            f"{path} holds {len(points)} sets of points and {len(triangles)} of triangles, not one "
            "surface: name the file with the surface, such as lh.pial.surf.gii"
        )
    with np.errstate(invalid="ignore"):
        vertices = points[0].data.astype(np.float64).reshape(-1, 3)
    part = checked_part(path, vertices, triangles[0].data.astype(np.int64).reshape(-1, 3))
    others = [a for a in image.darrays if a is not points[0] and a is not triangles[0]]
    vectors = [array for array in others if _are_normals(array.data, len(vertices))]
    contents = ["normals"] if vectors else []
    contents += ["values at vertices"] if len(others) > len(vectors) else []
    contents += ["metadata"] if image.meta or image.labeltable.labels else []
    return _Gifti(
        path=path, parts=[part], contents=contents, image=image, points=points[0], vectors=vectors
    )


def _are_normals(vectors: Any, count: int) -> bool:
    """Whether an array holds vectors of unit length at the vertices."""
    if vectors.shape != (count, 3) or vectors.dtype.kind != "f":
        return False
    return bool(np.allclose(np.linalg.norm(vectors, axis=1), 1, atol=1e-3))
