"""The lengths of a mesh that is read in chunks are those that filters measure."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from meshlab_spectral.filters.arrays import lengths_of
from meshlab_spectral.formats.opening import open_rows
from meshlab_spectral.tiles.survey import survey
from shapes import Arrays, grid, quads
from tiled_meshes import write_ply

SIDE = 40


def _terrain(filler: float | None, axis: int) -> Arrays:
    V = np.array([[i, j, np.sin(i / 8) * np.cos(j / 9)] for i in range(SIDE) for j in range(SIDE)])
    if filler is not None:
        V[[700, 701, 702, 741, 742], 2] = filler
    return np.roll(V, axis - 2, axis=1), quads(grid(SIDE, SIDE))


@pytest.mark.parametrize("filler", [None, -9999.0, -32768.0, 1e5, 2.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_walls_around_missing_data_are_no_edges(
    filler: float | None, axis: int, tmp_path: Path
) -> None:
    V, F = _terrain(filler, axis)
    write_ply(source := tmp_path / "terrain.ply", V, F, "<f8")
    measured = survey(open_rows(source), lambda *_: None).lengths
    assert tuple(measured) == pytest.approx(tuple(lengths_of(V, F)), rel=1e-12)
    flat = lengths_of(*_terrain(None, axis))
    assert abs(filler or 0.0) < 100 or measured.mean_edge < 1.2 * flat.mean_edge


def test_long_sides_of_a_part_are_edges(tmp_path: Path) -> None:
    V, F = _terrain(None, 2)
    V = np.vstack([V, [[-160.0, 0.0, 0.0], [-70.0, 1.0, 0.0]]])
    F = np.vstack([F, [[0, 1, SIDE**2], [1, SIDE**2 + 1, SIDE**2]]])
    write_ply(source := tmp_path / "part.ply", V, F, "<f8")
    measured = survey(open_rows(source), lambda *_: None).lengths
    assert tuple(measured) == pytest.approx(tuple(lengths_of(V, F)), rel=1e-12)
