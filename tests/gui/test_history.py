"""What a user has done, previewed and stopped: the saved script repeats what was done."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import plyfile
from desktop import Desktop
from filter_dialog import FilterDialog
from fractional import MENU, PARAMETERS, assert_same_in_floats, load, vertices
from meshlab import MeshLab
from test_layers import STEPS, layer, stop


def opened(meshlab: MeshLab, **values: str) -> FilterDialog:
    """The dialog, with values as a user sets them; one step unless they say otherwise."""
    dialog = meshlab.open_filter(*MENU)
    dialog.show_advanced()
    rows = dict(zip(PARAMETERS, dialog.rows(), strict=True))
    for name, value in {"steps": "1", **values}.items():
        dialog.set_value(rows[name], value)
    return dialog


def test_the_script_of_ten_actions_gives_the_mesh_on_the_screen(
    meshlab: MeshLab, desktop: Desktop, bunny: Path
) -> None:
    dialog = opened(meshlab)
    dialog.apply()  # 1
    dialog.close()
    dialog = opened(meshlab, feature_size="3")
    dialog.preview(True)  # 2
    dialog.preview(False)
    dialog.close()
    dialog = opened(meshlab)
    dialog.preview(True)
    dialog.apply()  # 3
    dialog.close()
    dialog = opened(meshlab, feature_size="4")
    dialog.preview(True)  # 4
    dialog.close()
    stop(meshlab, desktop, opened(meshlab, steps=str(STEPS)))  # 5
    dialog = opened(meshlab, keep_original="true")
    dialog.apply()  # 6
    dialog.close()
    for name in ("bunny (original)", "bunny"):  # 7
        desktop.click(layer(meshlab, name).box)
    dialog = opened(meshlab, color_by_displacement="true")
    dialog.preview(True)
    log = dialog.apply()  # 8
    dialog.close()
    dialog = meshlab.open_filter("Smoothing, Fairing and Deformation", "Spectral Equalizer")
    dialog.set_value(dialog.rows()[2], "1.5")
    dialog.preview(True)
    dialog.apply()  # 9
    dialog.close()
    stop(meshlab, desktop, opened(meshlab, steps=str(STEPS), keep_original="true"))  # 10

    assert "displacement along the normal, outwards positive, from -" in log
    script, shown = meshlab.home / "script.mlx", meshlab.home / "shown.ply"
    meshlab.save_script(script)
    meshlab.save_mesh(shown)
    assert len(list(ElementTree.parse(script).iter("filter"))) == 5
    assert meshlab.layers() == ["bunny", "bunny (original)"]
    repeated = load(bunny)
    repeated.load_filter_script(str(script))
    repeated.apply_filter_script()
    repeated.set_current_mesh(0)
    assert_same_in_floats(vertices(load(shown)), vertices(repeated))
    vertex = plyfile.PlyData.read(shown)["vertex"]
    colours = np.column_stack([vertex[name] for name in ("red", "green", "blue")])
    expected = np.rint(255 * repeated.current_mesh().vertex_color_matrix()[:, :3])
    assert len(np.unique(colours, axis=0)) > 100
    # A sign or a level differs where a float rounds the displacement.
    assert np.abs(colours.astype(float) - expected).mean() < 0.5
