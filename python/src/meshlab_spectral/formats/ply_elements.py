"""The elements of PLY files, whatever they are: header, tables of their numbers and lists."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from plyfile import PlyData, PlyElement, PlyListProperty

from meshlab_spectral._core import binary_numbers
from meshlab_spectral.formats.causes import EndsEarlyError, ForeignError, MayEndEarlyError
from meshlab_spectral.formats.document import Indices
from meshlab_spectral.formats.text import BYTE_ORDER_MARK, Lines, lines_of, rows_in_any_lines

_LARGEST_CUT = 1000  # largest ratio of what a file claims to hold to what it holds, as of STL
# Elements, or properties: Gaussian splats have 62, with learned features some 1,000. The time of
# plyfile grows with their square.
_MOST_NAMES = 10_000
Table = dict[str, Any]  # the numbers of a property; for lists their sizes, and all items


def read_header(content: bytes) -> tuple[PlyData, dict[str, int], bytes]:
    """Read the header with plyfile, without comments (it accepts only ASCII), with counts of 0."""
    if not content.removeprefix(BYTE_ORDER_MARK).startswith(b"ply"):
        raise ForeignError("it does not begin with the word ply")
    end = re.search(rb"\n[ \t]*end_header[ \t]*\r?\n", content)
    if not end:
        raise EndsEarlyError("it ends before the end of its header")
    header = content[: end.end()]
    lines = b"".join(
        line.strip() + b"\n" for line in header.removeprefix(BYTE_ORDER_MARK).splitlines()
    )
    lines = re.sub(rb"(?m)^(comment|obj_info)\b.*", b"comment", lines)
    counts = [int(word) for word in re.findall(rb"(?m)^element\s+\S+\s+(\S+)", lines)]
    properties = len(re.findall(rb"(?m)^property\b", lines))
    if max(len(counts), properties) > _MOST_NAMES:
        raise ValueError(
            f"it has {len(counts)} elements and {properties} properties, of {_MOST_NAMES} at most"
        )
    empty = re.sub(rb"(?m)^(element\s+\S+)\s+\S+", rb"\1 0", lines)
    ply = PlyData.read(io.BytesIO(empty))
    if "vertex" not in ply:
        raise ValueError("it has no PLY header with vertices")
    return ply, dict(zip([one.name for one in ply], counts, strict=True)), header


def read_elements(
    content: bytes, ply: PlyData, counts: dict[str, int], start: int
) -> tuple[dict[str, Table], Indices, int]:
    """Read all elements; return the byte offsets of text vertices, and that of binary ones, too."""
    if any(not 0 <= count <= len(content) for count in counts.values()):
        is_short = 0 <= min(counts.values()) <= max(counts.values()) < _LARGEST_CUT * len(content)
        reason = f"it cannot have {', '.join(map(str, counts.values()))} rows"
        raise MayEndEarlyError(reason) if is_short else ValueError(reason)
    lines = lines_of(content, begin=start, limit=sum(counts.values()) if ply.text else 0)
    try:
        return _read_tables(content, ply, counts, start, lines)
    except ValueError:
        elements = [(_are_lists(one), counts[one.name]) for one in ply]
        rows = next(rows_in_any_lines(lines, start, elements), None) if ply.text else None
        if rows is None:
            raise
        return _read_tables(content, ply, counts, start, rows)


def _read_tables(
    content: bytes, ply: PlyData, counts: dict[str, int], start: int, lines: Lines
) -> tuple[dict[str, Table], Indices, int]:
    """Read all elements from the lines of a text, or from a binary file."""
    tables, begin, at = dict[str, Table](), 0, 0
    starts = lines.starts[:0]
    for element in ply:
        count, properties = counts[element.name], element.properties
        own = lines[at : at + count]
        if element.name == "vertex":
            starts, begin = own.starts, start
        if ply.text:
            found, at = own.table(_are_lists(element), is_whole=True), at + count
        else:
            types = [(getattr(one, "len_dtype", ""), one.val_dtype) for one in properties]
            is_big = ply.byte_order == ">"
            found, start = binary_numbers(content, start, count, types, is_big)
        numbers, lists, bad, column = found
        if ply.text and bad >= 0:
            reasons = [f"property {one.name!r}: missing or malformed" for one in properties]
            reason = [*reasons, "expected end-of-line"][column]
            row = b" ".join(own.words_of(bad)).decode(errors="replace")[:80]
            raise own.fault(bad, f"element {element.name!r}: row {bad}: {reason}, in {row!r}")
        if bad >= 0 or (ply.text and len(own) < count):
            has_lists = not ply.text and any(types_[0] for types_ in types)
            raise (MayEndEarlyError if has_lists else EndsEarlyError)(
                f"it ends in element {element.name!r}, which has {count} rows"
            )
        single, several = iter(numbers.T), iter(lists)
        tables[element.name] = {
            one.name: next(several if isinstance(one, PlyListProperty) else single)
            for one in properties
        }
    return tables, starts, begin


def _are_lists(element: PlyElement) -> list[bool]:
    return [isinstance(one, PlyListProperty) for one in element.properties]


def row_type(element: PlyElement, order: str, size_of: Callable[[Any], int]) -> np.dtype[Any]:
    """Return the type of binary rows; `size_of` a list, given the fields up to its size."""
    fields = list[Any]()
    for one in element.properties:
        shape: tuple[int, ...] = ()
        if isinstance(one, PlyListProperty):
            fields.append((f"{one.name}\n", order + one.len_dtype))
            shape = (size_of(fields),)
        fields.append((one.name, order + one.val_dtype, shape))
    return np.dtype(fields)


def write_ply(path: Path, V: ArrayLike, F: ArrayLike, **more: NDArray[Any]) -> None:
    """Write a mesh as a binary file; `more` are further properties of its vertices."""
    columns = dict(zip("xyz", np.asarray(V, np.float64).T, strict=True)) | more
    vertices = np.empty(len(columns["x"]), [(name, one.dtype) for name, one in columns.items()])
    for name, column in columns.items():
        vertices[name] = column
    corners = np.asarray(F)
    faces = np.empty(len(corners), [("vertex_indices", "i4", (3,))])
    faces["vertex_indices"] = corners
    described = PlyElement.describe
    PlyData([described(vertices, "vertex"), described(faces, "face")]).write(str(path))
