"""Keep the original: the mesh as it was stays, in a layer of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from filter_dialog import FilterDialog
from fractional import FILTER, PARAMETERS, assert_same_in_floats, load, saved_vertices, vertices
from meshlab import MeshLab

LAYER = "bunny(1)"


@pytest.mark.parametrize("is_previewed", [False, True])
def test_apply_keeps_the_original_once_and_a_preview_does_not(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path, is_previewed: bool
) -> None:
    row = dialog.rows()[PARAMETERS.index("keep_original")]
    dialog.set_value(row, "true")
    if is_previewed:
        dialog.preview(True)
    assert meshlab.layers() == ["bunny"]
    assert f"the original is kept, hidden: layer {LAYER}" in dialog.apply()
    assert row.editors[-1].checked
    dialog.close()
    assert meshlab.layers() == ["bunny", LAYER]
    mesh_set = load(bunny)
    mesh_set.apply_filter(FILTER)
    assert_same_in_floats(saved_vertices(meshlab, "filtered.ply"), vertices(mesh_set))


def test_in_pymeshlab_the_layer_is_the_input(bunny: Path) -> None:
    mesh_set = load(bunny)
    before = vertices(mesh_set)
    mesh_set.apply_filter(FILTER, keep_original=True)
    assert mesh_set.mesh_number() == 2
    assert mesh_set.current_mesh_id() == 0
    assert np.abs(vertices(mesh_set) - before).max() > 0
    np.testing.assert_array_equal(mesh_set.mesh(1).vertex_matrix(), before)
