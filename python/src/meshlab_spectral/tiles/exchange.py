"""Handing each face to every tile that needs it, and writing what the tiles have moved."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.filters.progress import StageCallback
from meshlab_spectral.formats.document import Array, Indices
from meshlab_spectral.formats.rows import MeshRows, chunks, forget
from meshlab_spectral.tiles.cells import near_cells
from meshlab_spectral.tiles.plan import Plan, Workspace


def scatter(mesh: MeshRows, plan: Plan, work: Workspace, on_progress: StageCallback) -> None:
    """Append the corners of each face to the file of every tile whose cell it is near.

    If there is a selection, also whether the face is selected.
    """
    has_flags = plan.has_selection and mesh.flags[1]
    for i, j in chunks(mesh.faces):
        on_progress("dividing the mesh", i / mesh.faces)
        F = mesh.triangles(i, j)
        a, b, c = mesh.corners_of(F)
        low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        chosen = mesh.selected_faces(i, j) if has_flags else None
        for tile, rows in near_cells(plan.tree, low, high, plan.reach):
            if not len(rows):
                continue
            with work.file(tile, "faces").open("ab") as file:
                file.write(F[rows].astype("<u4").data)
            if chosen is not None:
                with work.file(tile, "chosen").open("ab") as file:
                    file.write(chosen[rows].data)
        mesh.forget()
    work.set_scattered()


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
