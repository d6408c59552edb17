"""Spectral Equalizer in MeshLab's dialog: with Preview, the shape follows the sliders."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pymeshlab
import pytest
from accessibility import Widget
from desktop import Desktop
from filter_dialog import FilterDialog
from fractional import diagonal, load, saved_vertices, vertices
from meshlab import MeshLab
from scene import scene_of, share_changed
from waiting import wait_for

FILTER = "apply_coord_spectral_equalizer"
MENU = ("Smoothing, Fairing and Deformation", "Spectral Equalizer")


def visible_sliders(dialog: FilterDialog) -> list[Widget]:
    """The sliders in octaves; MeshLab's own are behind them, hidden."""
    return [slider for slider in dialog.sliders() if slider.showing]


def press_on(dialog: FilterDialog, desktop: Desktop, slider: Widget, *keys: str) -> None:
    wait_for("the slider to have the keys", lambda: dialog.focus(slider))
    desktop.press_keys(*keys)


def test_the_shape_follows_a_slider_that_is_moved(
    meshlab: MeshLab, desktop: Desktop, bunny: Path
) -> None:
    dialog = meshlab.open_filter(*MENU)
    dialog.move(1000, 20)
    scene = scene_of(meshlab, dialog)
    before = desktop.settled_picture(scene)
    dialog.preview(True)
    assert share_changed(before, desktop.settled_picture(scene)) < 0.001  # all gains are 1
    slider, row = visible_sliders(dialog)[2], dialog.rows()[2]
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
    ms.apply_filter(FILTER, gain_8x=0.0, smallest_size=size, accurate=True)
    assert f"Spectral Equalizer: {row.label[0].lower()}{row.label[1:]} x 0;" in log
    assert "Preview" not in log
    distance = np.abs(saved_vertices(meshlab) - vertices(ms)).max()
    assert distance <= 1e-6 * diagonal(vertices(ms))


def test_a_slider_moved_back_shows_the_mesh_as_it_was(meshlab: MeshLab, desktop: Desktop) -> None:
    dialog = meshlab.open_filter(*MENU)
    dialog.move(1000, 20)
    scene = scene_of(meshlab, dialog)
    before = desktop.settled_picture(scene)
    dialog.preview(True)
    slider = visible_sliders(dialog)[2]
    press_on(dialog, desktop, slider, "Prior")
    wait_for("the picture to change", lambda: share_changed(before, desktop.picture(scene)) > 0.02)
    desktop.press_keys("Next")
    wait_for(
        "the picture to be as before", lambda: share_changed(before, desktop.picture(scene)) < 0.001
    )


def test_the_middle_of_a_slider_is_unchanged_and_a_tick_doubles(
    meshlab: MeshLab, desktop: Desktop
) -> None:
    dialog = meshlab.open_filter(*MENU)
    dialog.move(1000, 20)
    sliders = visible_sliders(dialog)
    assert len(sliders) == 6
    row = dialog.rows()[0]
    assert float(row.editors[0].text) == 1.0
    press_on(dialog, desktop, sliders[0], "Prior")
    assert float(row.editors[0].text) == 2.0
    desktop.press_keys("Next", "Next")
    assert float(row.editors[0].text) == 0.5
    desktop.press_keys("Right")
    assert float(row.editors[0].text) == pytest.approx(2 ** (-11 / 12), rel=1e-3)


def test_labels_follow_the_smallest_size(meshlab: MeshLab) -> None:
    dialog = meshlab.open_filter(*MENU)
    dialog.set_value(dialog.rows()[6], "1")  # per cent
    labels = ["32", "16", "8", "4", "2", "1"]
    wait_for(
        "the labels to follow",
        lambda: all(
            f"({percent} %)" in row.label
            for percent, row in zip(labels, dialog.rows(), strict=False)
        ),
    )


def test_apply_is_accurate_although_the_preview_is_a_draft(
    meshlab: MeshLab, desktop: Desktop, bunny: Path
) -> None:
    dialog = meshlab.open_filter(*MENU)
    dialog.move(1000, 20)
    dialog.preview(True)
    logged = len(meshlab.log())
    press_on(dialog, desktop, visible_sliders(dialog)[3], "End")
    log = dialog.wait_for_result(logged)
    assert "Preview: " in log
    size = pymeshlab.PureValue(float(dialog.rows()[6].editors[0].text))
    assert "Moved: " in dialog.apply()
    script = meshlab.home / "script.mlx"
    dialog.close()
    meshlab.save_script(script)
    (accurate,) = (
        p for p in ElementTree.parse(script).iter("Param") if p.attrib["name"] == "accurate"
    )
    assert accurate.attrib["value"] == "true"
    ms = load(bunny)
    ms.apply_filter(FILTER, gain_4x=4.0, smallest_size=size, accurate=True)
    distance = np.abs(saved_vertices(meshlab) - vertices(ms)).max()
    assert distance <= 1e-6 * diagonal(vertices(ms))
