"""Keep the original: the mesh as it was stays, in a layer of its own."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from filter_dialog import FilterDialog
from fractional import FILTER, PARAMETERS, assert_same_in_floats, load, saved_vertices, vertices
from meshlab import MeshLab

LAYER = "bunny (original)"


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
    script = meshlab.home / "script.mlx"
    meshlab.save_script(script)
    (kept,) = (
        p for p in ElementTree.parse(script).iter("Param") if p.attrib["name"] == "keep_original"
    )
    assert kept.attrib["value"] == "true"
    assert meshlab.layers() == ["bunny", LAYER]
    mesh_set = load(bunny)
    mesh_set.apply_filter(FILTER)
    assert_same_in_floats(saved_vertices(meshlab, "filtered.ply"), vertices(mesh_set))
