"""Cells share the points among them, and reach as far as they are asked to."""

from __future__ import annotations

import numpy as np
import pytest
from meshlab_spectral.tiles.cells import near_cells, split

POINTS = np.random.default_rng(2).random((4000, 3)) * [3, 1, 2]


@pytest.mark.parametrize("cells", [1, 2, 3, 7, 16])
def test_every_point_is_in_one_of_cells_of_about_as_many(cells: int) -> None:
    found = dict(near_cells(split(POINTS, cells), POINTS, POINTS, 0.0))
    assert sorted(found) == list(range(cells))
    assert sorted(np.concatenate(list(found.values()))) == list(range(len(POINTS)))
    for rows in found.values():
        assert len(rows) == pytest.approx(len(POINTS) / cells, abs=cells)


def test_a_cell_has_the_points_within_reach_of_its_box() -> None:
    tree, reach = split(POINTS, 6), 0.2
    near = dict(near_cells(tree, POINTS, POINTS, reach))
    for cell, rows in near_cells(tree, POINTS, POINTS, 0.0):
        low, high = POINTS[rows].min(axis=0), POINTS[rows].max(axis=0)
        within = ((low - reach <= POINTS) & (high + reach >= POINTS)).all(axis=1)
        assert set(np.flatnonzero(within)) <= set(near[cell])
        assert len(near[cell]) < 1.1 * within.sum()
