"""What a user does while the filter is at work: MeshLab handles its widgets in every callback."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from accessibility import Widget
from desktop import Desktop
from filter_dialog import FilterDialog
from fractional import FILTER, PARAMETERS, assert_same_in_floats, load, saved_vertices, vertices
from meshlab import MeshLab
from numpy.typing import NDArray
from waiting import wait_for

STEPS = 100  # takes seconds on the bunny
STEPS_FOR_A_MINUTE = 1000
PROJECT = "Project_"  # in the title of MeshLab's window while it has one

# Looked up before a run: during one, MeshLab answers only ten queries a second.
Begin = Callable[[Widget], int]


@pytest.fixture
def begin(dialog: FilterDialog, meshlab: MeshLab) -> Begin:
    """Start a run of seconds by a button or box; return the length of the log at its start."""
    dialog.show_advanced()
    rows = dict(zip(PARAMETERS, dialog.rows(), strict=True))
    dialog.set_value(rows["steps"], str(STEPS))
    bar = meshlab.main_window().find("progress bar")
    assert bar is not None

    def run(button: Widget) -> int:
        before = len(meshlab.log())
        button.press()
        wait_for("the filter to be at work", lambda: bar.value >= 1)
        return before

    return run


def part(dialog: FilterDialog, role: str, name: str) -> Widget:
    widget = dialog.window.find(role, name)
    assert widget is not None, f"no {role} {name}"
    return widget


def filtered(bunny: Path) -> NDArray[np.float64]:
    mesh_set = load(bunny)
    mesh_set.apply_filter(FILTER, steps=STEPS)
    return vertices(mesh_set)


def assert_filtered_once(meshlab: MeshLab, bunny: Path) -> None:
    """The mesh is filtered once, and MeshLab has noted it once."""
    script = meshlab.home / "script.mlx"
    meshlab.save_script(script)
    assert len(list(ElementTree.parse(script).iter("filter"))) == 1
    assert_same_in_floats(saved_vertices(meshlab), filtered(bunny))


def test_a_preview_overtaken_by_another_one_does_not_come_back(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path
) -> None:
    dialog.show_advanced()
    steps = dict(zip(PARAMETERS, dialog.rows(), strict=True))["steps"]
    dialog.preview(True)
    before = len(meshlab.log())
    dialog.set_value(steps, str(STEPS_FOR_A_MINUTE))
    dialog.set_value(steps, "4")
    dialog.wait_for_result(before)
    previewed = saved_vertices(meshlab)
    log = meshlab.log()[before:]
    assert "stopped" not in log  # nothing of ours about the one that was abandoned
    mesh_set = load(bunny)
    report = mesh_set.apply_filter(FILTER, steps=4)
    assert log.count("Spectral Filter: ") == 1
    assert f" on average, {report['max_displacement']:.2g} at most (" in log
    assert_same_in_floats(previewed, vertices(mesh_set))


def test_a_preview_switched_off_while_it_is_computed_does_not_come_back(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path, begin: Begin
) -> None:
    box = part(dialog, "check box", "Preview")
    before = begin(box)
    box.press()
    dialog.wait_for_result(before)
    wait_for("Preview to be switched off", lambda: not box.checked)
    assert f"steps: {STEPS}," in meshlab.log()[before:], "switched off too late"
    np.testing.assert_array_equal(saved_vertices(meshlab, "off.ply"), vertices(load(bunny)))

    dialog.preview(True)
    assert_same_in_floats(saved_vertices(meshlab, "on.ply"), filtered(bunny))


def test_apply_pressed_again_while_it_is_at_work_applies_once(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path, begin: Begin
) -> None:
    button = part(dialog, "push button", "Apply")
    before = begin(button)
    assert not button.enabled
    button.press()
    dialog.wait_for_result(before)
    wait_for("Apply to be offered again", lambda: button.enabled)
    dialog.close()
    assert_filtered_once(meshlab, bunny)


def test_apply_clicked_from_a_field_with_a_new_value_waits_for_the_preview_of_that_value(
    dialog: FilterDialog, meshlab: MeshLab, desktop: Desktop, bunny: Path
) -> None:
    dialog.show_advanced()
    steps = dialog.rows()[PARAMETERS.index("steps")]
    dialog.set_value(steps, "1")
    dialog.preview(True)
    dialog.type_value(steps, str(STEPS))
    before = len(meshlab.log())
    button = part(dialog, "push button", "Apply")
    desktop.click(button.box)
    wait_for("a preview and Apply", lambda: meshlab.log()[before:].count("Applied filter: ") == 2)
    wait_for("Apply to have the keys again", lambda: button.focused)
    dialog.close()
    assert_filtered_once(meshlab, bunny)


def assert_unchanged(meshlab: MeshLab, bunny: Path) -> None:
    np.testing.assert_array_equal(saved_vertices(meshlab), vertices(load(bunny)))


def test_a_dialog_closed_during_a_preview_stops_it(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path, begin: Begin
) -> None:
    close = part(dialog, "push button", "Close")
    before = begin(part(dialog, "check box", "Preview"))
    close.press()
    dialog.wait_for_result(before)
    wait_for("the dialog to close", lambda: not dialog.window.showing)
    assert "stopped: the mesh is as it was" in meshlab.log()[before:]
    assert_unchanged(meshlab, bunny)


def test_a_dialog_closed_after_apply_stops_the_run(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path, begin: Begin
) -> None:
    close = part(dialog, "push button", "Close")
    begin(part(dialog, "push button", "Apply"))
    close.press()
    assert "stopped: the mesh is as it was" in meshlab.message("Filter Failure")
    wait_for("the dialog to close", lambda: not dialog.window.showing)
    assert_unchanged(meshlab, bunny)


def test_escape_stops_a_run(
    dialog: FilterDialog, meshlab: MeshLab, desktop: Desktop, bunny: Path, begin: Begin
) -> None:
    begin(part(dialog, "push button", "Apply"))
    desktop.press_keys("Escape")
    assert "stopped: the mesh is as it was" in meshlab.message("Filter Failure")
    assert dialog.window.showing
    assert_unchanged(meshlab, bunny)


def test_a_project_closed_while_the_filter_is_at_work_is_closed_after_it_has_stopped(
    dialog: FilterDialog, meshlab: MeshLab, begin: Begin
) -> None:
    close = meshlab.menu_entry("File", "Close Project")
    assert close is not None
    assert PROJECT in meshlab.main_window().name
    before = begin(part(dialog, "check box", "Preview"))
    close.press()
    meshlab.answer("MeshLab", "Yes")  # to closing without saving
    wait_for("the project to be closed", lambda: PROJECT not in meshlab.main_window().name)
    assert "stopped: the mesh is as it was" in meshlab.log()[before:]


def test_meshlab_closed_while_the_filter_is_at_work_ends_after_it_has_stopped(
    dialog: FilterDialog, meshlab: MeshLab, begin: Begin
) -> None:
    leave = meshlab.menu_entry("File", "Exit")
    assert leave is not None
    before = begin(part(dialog, "check box", "Preview"))
    leave.press()
    assert meshlab.wait_for_end() == 0
    assert "stopped: the mesh is as it was" in meshlab.log()[before:]
