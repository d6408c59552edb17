"""Brain surfaces: GIFTI (.gii, .gii.gz) and FreeSurfer geometry (lh.pial, lh.white, ...).

nibabel reads and writes GIFTI. It drops XML comments, keeps one coordinate system per array, and
writes matrices with six decimals. Arrays of numbers as text would also lose digits: they become
binary, and so do those in files of their own, which nibabel cannot write. FreeSurfer's coordinates
are replaced in place.
"""

from __future__ import annotations

import base64
import gzip
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.errors import MeshFileError, SpectralError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.formats.budget import Budget
from meshlab_spectral.formats.causes import EndsEarlyError, ForeignError, unreadable, unsupported
from meshlab_spectral.formats.digits import precision_warnings
from meshlab_spectral.formats.document import Array, Document, checked_part
from meshlab_spectral.formats.names import (
    FREE_SURFER,
    OTHERS,
    QUADRILATERALS,
    TRIANGLES,
    shown,
)
from meshlab_spectral.formats.normals import are_normals, following_normals
from meshlab_spectral.formats.side_files import beside
from meshlab_spectral.formats.text import numbers_from
from meshlab_spectral.warned import Warned

_TEXT, _BINARY, _PACKED, _EXTERNAL = 1, 2, 3, 4  # encodings of GIFTI
_MOST_DIMENSIONS = 6  # in GIFTI
_ARRAY_BYTES = 4096  # of nibabel's objects for one
_BUFFER = 35_000_000  # of its parser, bytes


def read(path: Path) -> Document:
    """Read a GIFTI or FreeSurfer surface; see `open_document`.

    Vertices have the stored coordinates, as in nibabel and Connectome Workbench: neither GIFTI's
    matrices, which transform to other spaces, nor FreeSurfer's volume geometry are applied.
    """
    with path.open("rb") as file:
        magic = file.read(3)
    is_gifti = path.name.lower().endswith((".gii", ".gii.gz"))
    try:
        if magic == TRIANGLES:
            return _read_free_surfer(path)
        if magic in (QUADRILATERALS, OTHERS):
            return _read_quadrilaterals(path)
        if not is_gifti:
            raise ForeignError("it does not begin as one")
        return _read_gifti(path)
    except SpectralError:
        raise
    except Exception as error:  # nibabel raises whatever its parsers do
        ending = "gii.gz" if path.suffix.lower() == ".gz" else "gii" if is_gifti else FREE_SURFER
        reason: object = EndsEarlyError(error) if isinstance(error, EOFError) else error
        if isinstance(error, AssertionError | AttributeError | LookupError | TypeError):
            reason = f"its elements are not those of GIFTI: {type(error).__name__} {error}"
        raise unreadable(path, reason, ending) from error


@dataclass(kw_only=True)
class _FreeSurfer(Document):
    head: bytes  # up to the coordinates
    tail: bytes  # behind them

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        before, after = self.parts[0].vertices, moved[0]
        target.write_bytes(self.head + after.astype(">f4").tobytes() + self.tail)
        return precision_warnings(before, after, target.name)


def _read_free_surfer(path: Path) -> Document:
    data = path.read_bytes()
    second = data.find(b"\n") + 1
    # After a line, two counts; most writers put an empty line between, which FreeSurfer skips.
    begin = second + data.startswith(b"\n", second) + 8
    if second == 0 or begin > len(data):
        raise EndsEarlyError("it ends before its counts")
    n, m = np.frombuffer(data, ">i4", 2, begin - 8).tolist()
    tail = begin + 12 * (n + m)
    if n < 0 or m < 0 or tail > len(data):
        reason = f"it claims {n} vertices and {m} triangles, in {len(data)} bytes"
        raise EndsEarlyError(reason) if min(n, m) >= 0 else ValueError(reason)
    with np.errstate(invalid="ignore"):  # checked_part reports non-finite values
        vertices = np.frombuffer(data, ">f4", 3 * n, begin).reshape(-1, 3).astype(np.float64)
    faces = np.frombuffer(data, ">i4", 3 * m, begin + 12 * n).reshape(-1, 3).astype(np.int64)
    contents = ["volume geometry"] if tail < len(data) else []
    return _FreeSurfer(
        path=path,
        parts=[checked_part(path, vertices, faces)],
        contents=contents,
        head=data[:begin],
        tail=data[begin + 12 * n :],
    )


def _read_quadrilaterals(path: Path) -> Document:
    """Read quadrilaterals, in FreeSurfer's old layout, too: coordinates in whole hundredths."""
    data = path.read_bytes()
    is_old = data.startswith(OTHERS)
    type_, begin = np.dtype(">i2" if is_old else ">f4"), 9
    n, m = (int.from_bytes(data[k : k + 3], "big") for k in (3, 6))
    middle = begin + 3 * n * type_.itemsize
    if is_old and middle + 12 * m != len(data):  # values begin with the same bytes
        raise unsupported(
            path, "holds values of FreeSurfer, not a surface", "name the surface, such as lh.pial"
        )
    if middle + 12 * m > len(data):
        raise EndsEarlyError(f"it claims {n} vertices and {m} faces, in {len(data)} bytes")
    with np.errstate(invalid="ignore"):  # checked_part reports non-finite values
        vertices = np.frombuffer(data, type_, 3 * n, begin).reshape(-1, 3).astype(np.float64)
    vertices /= 100 if is_old else 1
    bytes_ = np.frombuffer(data, np.uint8, 12 * m, middle).reshape(m, 4, 3).astype(np.int64)
    a, b, c, d = (bytes_ @ [65536, 256, 1]).T
    is_even = a % 2 == 0  # FreeSurfer's choice of the diagonal
    halves = np.where(is_even, [a, b, d, c, d, b], [a, b, c, a, c, d])
    return _FreeSurfer(
        path=path,
        parts=[checked_part(path, vertices, halves.T.reshape(-1, 3))],
        contents=["polygons"],
        head=QUADRILATERALS + data[3:begin],
        tail=data[middle:],
    )


@dataclass(kw_only=True)
class _Gifti(Document):
    image: Any  # nibabel.gifti.GiftiImage
    points: Any  # its GiftiDataArray with the coordinates
    vectors: list[Any]  # its arrays of normals

    def side_files(self) -> list[str]:
        arrays = self.image.darrays
        return sorted({array.ext_fname for array in arrays if array.encoding == _EXTERNAL})

    def keeps(self, target: Path) -> bool:
        return _is_packed(target) == _is_packed(self.path)

    def write(self, target: Path, moved: Sequence[Array]) -> list[Warned]:
        (part,), (after,), external = self.parts, moved, self.side_files()
        for array in self.vectors:
            normals = array.data.astype(np.float64)
            new = following_normals(part.vertices, after, part.faces, normals)
            array.data = new.astype(array.data.dtype)
        self.points.data = after.astype(self.points.data.dtype)
        for array in self.image.darrays:
            if array.encoding == _EXTERNAL or (
                array.encoding == _TEXT and array.data.dtype.kind == "f"
            ):
                array.encoding, array.ext_fname, array.ext_offset = _BINARY, "", 0
        content = self.image.to_bytes(mode="force")  # force: doubles are allowed, too
        target.write_bytes(gzip.compress(content, mtime=0) if _is_packed(target) else content)
        warnings = [
            Warned("side_file", f"the numbers of {shown(name)} are written into {target.name}")
            for name in external
        ]
        return warnings + precision_warnings(part.vertices, after, target.name)


def _is_packed(path: Path) -> bool:
    return path.suffix.lower() == ".gz"


def _read_gifti(path: Path) -> Document:
    check_extras("formats")
    budget = Budget(path, path.stat().st_size)
    with path.open("rb") as file:
        content = file.read()
    if _is_packed(path):
        with gzip.open(path) as packed:
            content = budget.unpacked(packed, "its XML")
    image = _parsed(path, content, budget)
    if image is None:
        raise ValueError("it is XML, but not GIFTI")
    points = image.get_arrays_from_intent("NIFTI_INTENT_POINTSET")
    triangles = image.get_arrays_from_intent("NIFTI_INTENT_TRIANGLE")
    if len(points) != 1 or len(triangles) != 1:
        raise MeshFileError(
            f"{path} holds {len(points)} sets of points and {len(triangles)} of triangles, not one "
            "surface: name the file with the surface, such as lh.pial.surf.gii",
            "unsupported",
        )
    with np.errstate(invalid="ignore"):
        vertices = points[0].data.astype(np.float64).reshape(-1, 3)
    part = checked_part(path, vertices, triangles[0].data.astype(np.int64).reshape(-1, 3))
    others = [a for a in image.darrays if a is not points[0] and a is not triangles[0]]
    vectors = [array for array in others if are_normals(array.data, len(vertices))]
    contents = ["normals"] if vectors else []
    contents += ["values at vertices"] if len(others) > len(vectors) else []
    contents += ["metadata"] if image.meta or image.labeltable.labels else []
    return _Gifti(
        path=path, parts=[part], contents=contents, image=image, points=points[0], vectors=vectors
    )


def _parsed(path: Path, content: bytes, budget: Budget) -> Any:
    """Parse GIFTI with nibabel, which would read whatever a file claims or names."""
    from nibabel.gifti.parse_gifti_fast import GiftiImageParser

    class Parser(GiftiImageParser):  # type: ignore[misc]
        def StartElementHandler(self, name: str, attributes: dict[str, str]) -> None:
            if name == "DataArray":
                budget.take(_ARRAY_BYTES, "its arrays")
                if int(attributes.get("Dimensionality", 0)) > _MOST_DIMENSIONS:
                    raise ValueError(
                        f"an array has {shown(attributes['Dimensionality'])} dimensions, of "
                        f"{_MOST_DIMENSIONS} at most"
                    )
            super().StartElementHandler(name, attributes)

        def flush_chardata(self) -> None:
            if self.write_to != "Data":
                super().flush_chardata()
                return
            text = "".join(self._char_blocks or ())
            self._char_blocks: list[str] | None = None
            self.da.data = _data(path, self.da, text, budget)

    parser = Parser(buffer_size=min(len(content) + 1, _BUFFER))
    parser.parse(string=content)
    return parser.img


def _data(path: Path, array: Any, text: str, budget: Budget) -> Any:
    """Return the numbers of an array, as many as its dimensions say."""
    from nibabel.gifti.util import array_index_order_codes, gifti_endian_codes
    from nibabel.nifti1 import data_type_codes

    endian = gifti_endian_codes.byteorder[array.endian]
    type_ = data_type_codes.dtype[array.datatype].newbyteorder(endian)
    count = math.prod(array.dims)
    size = count * type_.itemsize
    if min(array.dims, default=0) < 0:
        raise ValueError(f"an array has the dimensions {array.dims}")
    if array.encoding == _TEXT:
        with np.errstate(invalid="ignore"):
            numbers = numbers_from(text.encode(), 0, count, "an array").astype(type_)
    elif array.encoding == _EXTERNAL:
        file = beside(path, array.ext_fname)
        budget.extend(file.stat().st_size)
        budget.take(size, f"an array of {count} numbers")
        numbers = np.fromfile(file, type_, count, offset=array.ext_offset)
    elif array.encoding in (_BINARY, _PACKED):
        content = base64.b64decode(text)
        if array.encoding == _PACKED:
            budget.take(size, f"an array of {count} numbers")
            content = zlib.decompressobj().decompress(content, size + 1)
        if len(content) > size:
            raise ValueError(f"an array of {count} numbers has more")
        size_of_all = len(content) - len(content) % type_.itemsize
        numbers = np.frombuffer(bytearray(content[:size_of_all]), type_)
    else:
        raise ValueError(f"it has an encoding of the number {array.encoding}")
    if len(numbers) != count:
        reason = f"an array of {count} numbers has {len(numbers)}"
        raise EndsEarlyError(reason) if len(numbers) < count else ValueError(reason)
    return numbers.reshape(array.dims, order=array_index_order_codes.npcode[array.ind_ord])
