"""Dialogs that stay open while layers and projects change, and previews that nobody applies."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from accessibility import Box, Widget
from desktop import Desktop
from filter_dialog import FilterDialog
from fractional import MENU, PARAMETERS, load, saved_vertices, vertices
from meshlab import MeshLab
from scene import scene_of, share_changed
from waiting import wait_for

STEPS = 100  # takes seconds on the bunny


def layer(meshlab: MeshLab, name: str) -> Widget:
    """The name of a layer in the list beside the scene; a click on it makes it the current one."""
    items = meshlab.main_window().find_all("tree item")
    return next(item for item in items if item.name.removesuffix(" *") == name)


def stop(meshlab: MeshLab, desktop: Desktop, dialog: FilterDialog) -> None:
    """Apply, and press Esc during the run."""
    bar = meshlab.main_window().find("progress bar")
    assert bar is not None
    dialog.press("Apply")
    wait_for("the filter to be at work", lambda: bar.value >= 1)
    desktop.press_keys("Escape")
    assert "stopped: the mesh is as it was" in meshlab.message("Filter Failure")
    dialog.close()


def is_on_screen(box: Box) -> bool:
    return box.x + box.width <= 1600 and box.y + box.height <= 1000


def assert_nothing_in_the_history(meshlab: MeshLab) -> None:
    script = meshlab.home / "script.mlx"
    meshlab.save_script(script)
    assert list(ElementTree.parse(script).iter("filter")) == []


def assert_unchanged(meshlab: MeshLab, bunny: Path) -> None:
    np.testing.assert_array_equal(saved_vertices(meshlab), vertices(load(bunny)))


def test_a_dialog_closed_without_apply_ends_its_preview(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path
) -> None:
    dialog.preview(True)
    dialog.close()
    assert_unchanged(meshlab, bunny)
    assert_nothing_in_the_history(meshlab)


def test_a_dialog_closed_after_apply_leaves_what_was_applied(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path
) -> None:
    dialog.preview(True)
    previewed = saved_vertices(meshlab, "previewed.ply")
    dialog.apply()
    dialog.close()
    np.testing.assert_array_equal(saved_vertices(meshlab), previewed)
    assert not np.array_equal(previewed, vertices(load(bunny)))


def test_escape_during_apply_with_a_preview_leaves_no_entry_in_the_history(
    dialog: FilterDialog, meshlab: MeshLab, desktop: Desktop, bunny: Path
) -> None:
    dialog.show_advanced()
    rows = dict(zip(PARAMETERS, dialog.rows(), strict=True))
    dialog.set_value(rows["keep_original"], "true")  # Apply is then a run of its own
    dialog.set_value(rows["steps"], str(STEPS))
    dialog.preview(True)
    stop(meshlab, desktop, dialog)
    assert_unchanged(meshlab, bunny)
    assert_nothing_in_the_history(meshlab)


def test_a_dialog_of_another_layer_refuses_its_lengths_and_shows_both_as_they_are(
    meshlab: MeshLab, desktop: Desktop
) -> None:
    sphere = meshlab.open_filter("Create New Mesh Layer", "Sphere")
    sphere.set_value(sphere.rows()[0], "0.05")  # hides nothing of the bunny
    sphere.apply()
    sphere.close()
    desktop.click(layer(meshlab, "bunny").box)
    dialog = meshlab.open_filter(*MENU)
    dialog.move(580, 20)  # between the scene and the layers
    dialog.set_value(dialog.rows()[PARAMETERS.index("feature_size")], "30")
    scene = scene_of(meshlab, dialog)
    before = desktop.settled_picture(scene)
    dialog.preview(True)
    wait_for("the picture to change", lambda: share_changed(before, desktop.picture(scene)) > 0.02)
    desktop.click(layer(meshlab, "Sphere").box)
    message = meshlab.message("Filter Failure")
    assert 'the sizes of layer "bunny"' in message
    assert 'the current layer is "Sphere"' in message
    wait_for(
        "the picture to be as before", lambda: share_changed(before, desktop.picture(scene)) < 0.001
    )


def test_a_dialog_of_a_project_that_is_not_shown_says_that_there_is_no_mesh(
    dialog: FilterDialog, meshlab: MeshLab
) -> None:
    meshlab.choose("File", "New Empty Project...")
    assert "there is no mesh" in dialog.fail()


def test_a_slider_moved_quickly_agrees_with_its_field(meshlab: MeshLab, desktop: Desktop) -> None:
    dialog = meshlab.open_filter("Smoothing, Fairing and Deformation", "Spectral Equalizer")
    dialog.move(1000, 20)
    dialog.preview(True)
    slider = next(slider for slider in dialog.sliders() if slider.showing)
    wait_for("the slider to have the keys", lambda: dialog.focus(slider))
    field, position = dialog.rows()[0].editors[0], 0
    for keys in (["Right"] * 20, ["Left"] * 28 + ["Right"] * 3):
        before = len(meshlab.log())
        desktop.press_keys(*keys)
        dialog.wait_for_result(before)
        position += keys.count("Right") - keys.count("Left")
        wait_for("all keys to be handled", lambda at=position: slider.value == at)
        assert float(field.text) == pytest.approx(2 ** (position / 12), rel=1e-3)


def test_apply_and_close_are_on_the_screen_with_the_largest_fonts(
    install: Callable[[], None], start: Callable[..., MeshLab], bunny: Path
) -> None:
    install()
    dialog = start(bunny, QT_FONT_DPI="216").open_filter(
        "Smoothing, Fairing and Deformation", "Spectral Equalizer"
    )
    for name in ("Apply", "Close"):
        button = dialog.window.find("push button", name)
        assert button is not None
        wait_for(f"{name} to be on the screen", lambda w=button: is_on_screen(w.box))
