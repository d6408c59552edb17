"""Spectral Equalizer in MeshLab's dialog: with Preview, the shape follows the sliders."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pymeshlab
from desktop import Desktop
from fractional import diagonal, load, saved_vertices, vertices
from meshlab import MeshLab
from scene import scene_of, share_changed
from waiting import wait_for

MENU = ("Smoothing, Fairing and Deformation", "Spectral Equalizer")


def test_the_shape_follows_a_slider_that_is_moved(
    meshlab: MeshLab, desktop: Desktop, bunny: Path
) -> None:
    dialog = meshlab.open_filter(*MENU)
    dialog.move(1000, 20)
    scene = scene_of(meshlab, dialog)
    before = desktop.settled_picture(scene)
    dialog.preview(True)
    assert share_changed(before, desktop.settled_picture(scene)) < 0.001  # all gains are 1
    slider, row = dialog.sliders()[2], dialog.rows()[2]
    logged = len(meshlab.log())
    wait_for("the slider to have the keys", lambda: dialog.focus(slider))
    desktop.press_keys("End")
    dialog.wait_for_result(logged)
    assert float(row.editors[0].text) == 4.0
    wait_for("the picture to change", lambda: share_changed(before, desktop.picture(scene)) > 0.02)
    logged = len(meshlab.log())
    desktop.press_keys("Home")
    dialog.wait_for_result(logged)
    assert float(row.editors[0].text) == 0.0
    dialog.preview(False)
    wait_for(
        "the picture to be as before", lambda: share_changed(before, desktop.picture(scene)) < 0.001
    )
    np.testing.assert_array_equal(saved_vertices(meshlab, "back.ply"), vertices(load(bunny)))

    # MeshLab rounds the default to the digits that it shows.
    size = pymeshlab.PureValue(float(dialog.rows()[6].editors[0].text))
    log = dialog.apply()
    dialog.close()
    ms = load(bunny)
    ms.apply_filter("apply_coord_spectral_equalizer", gain_8x=0.0, smallest_size=size)
    assert f"Spectral Equalizer: {row.label[0].lower()}{row.label[1:]} x 0;" in log
    distance = np.abs(saved_vertices(meshlab) - vertices(ms)).max()
    assert distance <= 1e-6 * diagonal(vertices(ms))
