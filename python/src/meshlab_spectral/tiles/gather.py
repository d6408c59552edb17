"""Writing the output: the input with what the tiles have moved, in the order of the file."""

from __future__ import annotations

import mmap
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np

from meshlab_spectral.formats import ply, stl
from meshlab_spectral.formats.document import Array, Indices
from meshlab_spectral.tiles.plan import Workspace
from meshlab_spectral.tiles.rows import MeshRows, StageCallback, chunks


def gather(
    mesh: MeshRows,
    work: Workspace,
    tiles: int,
    target: Path,
    is_wide: bool,
    on_progress: StageCallback,
) -> None:
    """Write the output; `is_wide` widens the coordinates of a PLY file to double precision."""
    moved = _Moved(work, tiles, "xyz")
    normals = _Moved(work, tiles, "normals")
    per_row = 3 if mesh.is_joined_by_position else 1
    with mesh.path.open("rb") as source, target.open("wb") as file:
        header = source.read(len(mesh.header))
        file.write(ply.widened(header) if is_wide else header)
        _copy(source, file, mesh.begin - len(mesh.header))
        for i, j in chunks(len(mesh.block)):
            on_progress("writing", i / len(mesh.block))
            span = per_row * i, per_row * j
            if mesh.is_joined_by_position:
                rows = _facets(mesh.block[i:j], *moved.between(*span))
            else:
                columns: dict[tuple[str, ...], Any] = {ply.AXES: moved.between(*span)}
                if mesh.normals:
                    columns[ply.NORMALS] = normals.between(*span)
                wide = mesh.block.dtype["x"].str[0] if is_wide else None
                rows = ply.with_columns(mesh.block[i:j], columns, wide)
            file.write(rows.tobytes())
            mesh.forget()
        source.seek(mesh.begin + mesh.block.nbytes)
        shutil.copyfileobj(source, file, 1 << 22)


class _Moved:
    """What the tiles have written for each point, by ranges of points in ascending order."""

    def __init__(self, work: Workspace, tiles: int, kind: str) -> None:
        self._parts = []
        for tile in range(tiles):
            ids, rows = work.file(tile, "ids"), work.file(tile, kind)
            if rows.exists() and rows.stat().st_size:
                table = np.memmap(rows, "<f8", "r").reshape(-1, 3)
                self._parts.append((np.memmap(ids, "<u4", "r"), table))
        self._at = [0] * len(self._parts)

    def between(self, begin: int, end: int) -> tuple[Indices, Array]:
        """Return points in this range, counted from its begin, and their rows."""
        found: list[tuple[Any, Any]] = [(np.zeros(0, np.int64), np.zeros((0, 3)))]
        for k, (ids, table) in enumerate(self._parts):
            # Of the same type: NumPy would convert all of the array.
            at, last = self._at[k], int(np.searchsorted(ids, ids.dtype.type(end)))
            if last > at:
                found.append((ids[at:last].astype(np.int64) - begin, np.array(table[at:last])))
                self._at[k] = last
        for maps in self._parts:
            for one in maps:
                _forget(one)
        return np.concatenate([ids for ids, _ in found]), np.vstack([rows for _, rows in found])


def _forget(rows: Any) -> None:
    owner = rows
    while not hasattr(owner, "madvise") and owner is not None:
        owner = getattr(owner, "_mmap", None) or getattr(owner, "base", None)
    if owner is not None and hasattr(mmap, "MADV_DONTNEED"):
        owner.madvise(mmap.MADV_DONTNEED)


def _facets(rows: Any, where: Indices, moved: Array) -> Any:
    """Return facets with corners that have moved, and normals that follow."""
    before = rows["corners"].reshape(-1, 3).astype(np.float64)
    after = before.copy()
    after[where] = moved
    rows = np.array(rows, stl.TRIANGLE)
    stl.move(rows, before, after, np.arange(len(before)).reshape(-1, 3))
    return rows


def _copy(source: IO[bytes], file: IO[bytes], count: int) -> None:
    for part in _sizes(count):
        file.write(source.read(part))


def _sizes(count: int, size: int = 1 << 22) -> Iterator[int]:
    return (end - begin for begin, end in chunks(count, size))
