"""Writing the output: the input with what the tiles have moved, in the order of the file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.formats.document import Array, Indices
from meshlab_spectral.formats.rows import MeshRows, forget
from meshlab_spectral.tiles.plan import StageCallback, Workspace


def gather(
    mesh: MeshRows,
    work: Workspace,
    tiles: int,
    target: Path,
    is_wide: bool,
    on_progress: StageCallback,
) -> None:
    """Write the output; `is_wide` widens the coordinates of a PLY file to double precision."""
    moved, normals = (_Moved(work, tiles, kind).between for kind in ("xyz", "normals"))
    mesh.save(target, moved, normals, is_wide, lambda done: on_progress("writing", done))


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
                forget(one)
        return np.concatenate([ids for ids, _ in found]), np.vstack([rows for _, rows in found])
