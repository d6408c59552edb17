"""One tile, in a child process: a mesh that goes some way beyond its cell, of which it keeps that.

A tile decides nothing by itself that another might decide differently.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral._core import first_equal_rows, vertex_areas
from meshlab_spectral.errors import MeshError, MeshFileError
from meshlab_spectral.filters.progress import Progress
from meshlab_spectral.filters.running import TiledSurface, plain, run
from meshlab_spectral.formats.document import Array, Indices
from meshlab_spectral.formats.normals import following_normals
from meshlab_spectral.formats.opening import open_rows
from meshlab_spectral.formats.rows import MeshRows, chunks
from meshlab_spectral.tiles.cells import near_cells
from meshlab_spectral.tiles.plan import Workspace, write_whole


def filter_tile(
    folder: Path, tile: int, decided: dict[str, Any], on_stage: Progress
) -> dict[str, Any]:
    """Filter a tile and write what its cell owns, and its report last; return the report.

    `decided` are the number of "passes", and whether the surface "has_thin_parts" in any tile; or
    "noise_height" and "noise_size", 0 for those that the tile measures.
    """
    work = Workspace(folder)
    plan = work.plan()
    mesh = open_rows(Path(plan.source))
    faces = work.file(tile, "faces")
    corners = np.fromfile(faces, "<u4") if faces.exists() else np.zeros(0, "<u4")
    ids, F = _numbered(corners)
    V = mesh.gathered(ids)
    mine = next((rows for cell, rows in near_cells(plan.tree, V, V, 0.0) if cell == tile), None)
    own = np.zeros(0, np.int64) if mine is None else mine
    before, which = V, np.arange(len(V))
    if mesh.is_joined_by_position:
        before, which = _joined(V)
        F = which[F].astype(np.int32)
    after, report = before, dict[str, Any]()
    if len(own):
        options = plan.options_of_filter()
        inner = np.zeros(len(before), bool)
        inner[which[own]] = True
        diagonal, edge, of_surface = plan.lengths
        thin = bool(decided.get("has_thin_parts"))
        surface = TiledSurface(diagonal, edge, of_surface, thin, inner)
        selected = _selected(mesh, work, tile, ids, F) if plan.has_selection else None
        chosen = {name: value for name, value in decided.items() if name != "has_thin_parts"}
        parameters = options.core_parameters() | {k: value for k, value in chosen.items() if value}
        if selected is None or selected.any():  # else nothing here moves
            has_weight = parameters["weight"] != "none" and "quality" in mesh.kinds
            after, report = _filtered(
                options.FILTER,
                before,
                F,
                parameters,
                selected=selected,
                values=mesh.gathered(ids, "quality") if has_weight else None,
                progress=on_stage,
                whole=surface,
            )
    moved = after[which[own]]
    if work.plan() != plan:  # the run that has sent this tile to a worker of a cluster is over
        raise MeshFileError(f"another run has begun in {folder}")
    write_whole(work.file(tile, "ids"), np.ascontiguousarray(ids[own], "<u4").data)
    write_whole(work.file(tile, "xyz"), np.ascontiguousarray(moved, "<f8").data)
    if "normals" in mesh.kinds and len(own):
        old = mesh.gathered(ids, "normals")
        normals = following_normals(before, after, F.astype(np.int64), old)
        write_whole(work.file(tile, "normals"), np.ascontiguousarray(normals[own], "<f8").data)
    asked = {f"wanted_{name}": value for name, value in decided.items()}
    report |= (
        asked
        | {"ran": bool(report)}
        | _measures(before, after, F, which[own])
        | {"vertices": len(ids)}
    )
    write_whole(work.file(tile, "json"), json.dumps(report).encode())
    return report


def _numbered(corners: NDArray[np.uint32]) -> tuple[Indices, NDArray[np.integer]]:
    """Return the different points of corners, ascending, and triangles of their indices."""
    if not len(corners):
        return np.zeros(0, np.int64), np.zeros((0, 3), np.int64)
    first = int(corners.min())
    is_there = np.zeros(int(corners.max()) - first + 1, bool)
    is_there[corners - np.uint32(first)] = True
    ids = np.flatnonzero(is_there) + first
    if len(is_there) > 8 * len(ids):  # a shuffled file: the table would be larger than the tile
        return ids, np.searchsorted(ids, corners).astype(np.int32).reshape(-1, 3)
    new_index = np.cumsum(is_there, dtype=np.int32) - 1
    return ids, new_index[corners - np.uint32(first)].reshape(-1, 3)


def _joined(points: Array) -> tuple[Array, Indices]:
    """Merge points at the same position; return the others, and where each of all has gone."""
    first = first_equal_rows(points)
    is_new = first == np.arange(len(points))
    return points[is_new], (np.cumsum(is_new) - 1)[first]


def _selected(
    mesh: MeshRows, work: Workspace, tile: int, ids: Indices, F: NDArray[np.integer]
) -> NDArray[np.bool_]:
    """Return which vertices are selected, directly or by a face."""
    of_vertices, of_faces = mesh.flags
    chosen = np.zeros(len(ids), bool)
    if of_vertices:
        for i, j in chunks(len(ids)):
            chosen[i:j] = mesh.selected(ids[i:j])
            mesh.forget()
    if of_faces:
        chosen[F[np.fromfile(work.file(tile, "chosen"), bool)]] = True
    return chosen


def _filtered(
    name: str, V: Array, F: NDArray[np.integer], parameters: dict[str, Any], **inputs: Any
) -> tuple[Array, dict[str, Any]]:
    try:
        done = run(name, V, F, parameters, **inputs)
    except MeshError as error:
        if error.code != "no_area":  # the whole mesh may have some
            raise
        return V, {}
    report = plain(done.report)
    report.pop("step_sizes", None)
    return V if done.vertices is None else done.vertices, report


def _measures(
    before: Array, after: Array, F: NDArray[np.integer], own: Indices
) -> dict[str, float]:
    """Return sums over the vertices of a cell, from which those of the whole mesh are made."""
    is_own = np.zeros(len(before), bool)
    is_own[own] = True
    own = np.flatnonzero(is_own)  # corners of an STL file at one position are one vertex
    areas = [vertex_areas(X, F.astype(np.int32, copy=False))[own] for X in (before, after)]
    displacement = np.linalg.norm(after[own] - before[own], axis=1)
    moves = displacement > 0
    Y = after[own][moves]
    rounding = np.linalg.norm(Y.astype(np.float32) - Y, axis=1)
    return {
        "own": len(own),
        "own_area_before": float(areas[0].sum()),
        "own_area_after": float(areas[1].sum()),
        "moved": int(moves.sum()),
        "squares": float((areas[0] * displacement**2).sum()),
        "moved_squares": float((displacement**2).sum()),
        "rounding_squares": float((rounding**2).sum()),
        "largest": float(displacement.max(initial=0.0)),
        "largest_coordinate": float(np.abs(Y).max(initial=0.0)),
    }
