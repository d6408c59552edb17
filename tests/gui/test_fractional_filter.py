"""The filter in MeshLab's dialog: parameters, Preview, Apply, refusals, and resulting mesh."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import plyfile
import pymeshlab
import pytest
from desktop import Desktop
from filter_dialog import FilterDialog
from fractional import (
    FILTER,
    HEAD,
    MENU,
    PARAMETERS,
    assert_same_in_floats,
    default_feature_size,
    diagonal,
    load,
    mean_edge,
    saved_vertices,
    vertices,
)
from helpers import other_options
from meshlab import MeshLab
from meshlab_spectral import FilterOptions
from meshlab_spectral._core import filters, presets
from scene import scene_of, share_changed
from waiting import wait_for

# For every parameter but four, which stay as they are: see the test.
OTHER_VALUES = other_options(
    feature_size="8%",
    stop_gain=0.25,
    band_width=2.0,
    tolerance="0.25%",
    basis_size=40,
    crease_angle=150.0,
    preserve_volume=False,
    max_displacement="20%",
)
OTHER_VALUES |= {"color_by_displacement": True, "keep_original": True}


def test_the_dialog_shows_every_parameter_with_its_default(
    dialog: FilterDialog, bunny: Path
) -> None:
    rows = dialog.rows()
    own = {"color_by_displacement": False, "keep_original": False}
    defaults = {**FilterOptions().as_dict(), **own}
    assert len(rows) == len(PARAMETERS)
    assert len({row.label for row in rows}) == len(PARAMETERS)
    shown = [name for name, row in zip(PARAMETERS, rows, strict=True) if row.showing]
    assert shown == [
        "filter_type",
        "feature_size",
        "power",
        "pass_gain",
        "stop_gain",
        "color_by_displacement",
        "keep_original",
    ]
    dialog.show_advanced()
    for name, row in zip(PARAMETERS, rows, strict=True):
        assert row.showing, name
        assert len(row.tooltip) > len(row.label), name
        if len(row.editors) == 2:  # a length
            assert "The mean edge length of this mesh is " in row.tooltip, name
        if name == "feature_size":
            assert f"; edge {mean_edge(load(bunny)):.2g}" in row.label
        default = defaults[name]
        editor = row.editors[-1]
        if isinstance(default, bool):
            assert editor.checked == default, name
        elif name == "max_displacement":
            assert (default, float(editor.text)) == ("auto", 0.0)  # no bound
        elif name == "transfer_function":
            assert editor.text == default
        elif name == "feature_size":
            ms = load(bunny)
            percent = 100 * default_feature_size(ms) / diagonal(vertices(ms))
            assert float(editor.text) == pytest.approx(percent, rel=1e-3)
        elif len(row.editors) == 2:
            assert float(editor.text) == float(default.rstrip("%")), name
        elif editor.has_role("combo box"):
            assert editor.name == default, name
        else:
            assert float(editor.text) == default, name


def test_every_parameter_set_in_the_dialog_is_in_the_copied_call_and_the_saved_script(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path
) -> None:
    dialog.show_advanced()
    assert list(OTHER_VALUES) == PARAMETERS
    for row, value in zip(dialog.rows(), OTHER_VALUES.values(), strict=True):
        typed = str(value)
        dialog.set_value(row, typed.lower() if isinstance(value, bool) else typed.rstrip("%"))
    call = dialog.pymeshlab_call()
    # These keep their defaults, which a call leaves out: the bunny has no selection or quality,
    # details would leave nothing to compare, and so large an offset to preserve the volume would
    # show single-precision sizes in the normals of small triangles.
    for name in set(PARAMETERS) - {"selected", "preserve_volume", "weight", "result"}:
        assert f"{name} = " in call, name
    dialog.apply()
    dialog.close()
    in_meshlab = saved_vertices(meshlab)
    script = meshlab.home / "script.mlx"
    meshlab.save_script(script)

    (entry,) = ElementTree.parse(script).iter("filter")
    assert entry.attrib["name"] == MENU[-1]
    assert [parameter.attrib["name"] for parameter in entry.iter("Param")] == PARAMETERS

    ms = load(bunny)
    exec(call, {"ms": ms, "pymeshlab": pymeshlab})
    by_call = vertices(ms)
    other = load(bunny)
    other.load_filter_script(str(script))
    other.apply_filter_script()
    assert np.abs(by_call - vertices(load(bunny))).max() > 1e-3
    assert_same_in_floats(in_meshlab, by_call)
    assert_same_in_floats(in_meshlab, vertices(other))


def test_the_strength_has_a_slider_of_percent(
    dialog: FilterDialog, meshlab: MeshLab, desktop: Desktop, bunny: Path
) -> None:
    field = dialog.rows()[PARAMETERS.index("power")].editors[0]
    (slider,) = (slider for slider in dialog.sliders() if slider.showing)
    wait_for("the slider to have the keys", lambda: dialog.focus(slider))
    desktop.press_keys("Prior", "Prior")  # a tenth each
    assert float(field.text) == 1.0
    desktop.press_keys("Next", "Next", "Left")
    wait_for("the field to follow", lambda: float(field.text) == 0.79)
    dialog.apply()
    dialog.close()
    ms = load(bunny)
    ms.apply_filter(FILTER, power=0.79)
    assert_same_in_floats(saved_vertices(meshlab), vertices(ms))


def test_preview_changes_the_picture_and_switching_it_off_restores_the_mesh(
    dialog: FilterDialog, meshlab: MeshLab, desktop: Desktop, bunny: Path
) -> None:
    # Strong enough to be seen from afar.
    dialog.set_value(dialog.rows()[PARAMETERS.index("feature_size")], "10")
    dialog.move(1000, 20)
    scene = scene_of(meshlab, dialog)
    before = desktop.settled_picture(scene)
    assert np.ptp(before) > 100, "the picture shows nothing"
    dialog.preview(True)
    wait_for("the picture to change", lambda: share_changed(before, desktop.picture(scene)) > 0.02)
    dialog.preview(False)
    wait_for(
        "the picture to be as before", lambda: share_changed(before, desktop.picture(scene)) < 0.001
    )
    dialog.close()
    np.testing.assert_array_equal(saved_vertices(meshlab), vertices(load(bunny)))


@pytest.mark.parametrize(
    "turns",
    [("script", "dialog") * 2 + ("script",), ("dialog", "script") * 2],
    ids=["script first", "dialog first"],
)
def test_scripts_and_the_dialog_alternate_as_in_pymeshlab(
    meshlab: MeshLab, bunny: Path, turns: tuple[str, ...]
) -> None:
    ms = load(bunny)
    sizes: list[float] = []  # of the script, in which MeshLab stores lengths, not percentages

    def apply(size: float) -> None:
        ms.apply_filter(FILTER, steps=1, feature_size=pymeshlab.PureValue(size))

    if turns[0] == "script":
        sizes.append(0.1)
        apply(sizes[0])
        script = meshlab.home / "script.mlx"
        ms.save_filter_script(str(script))
        meshlab.apply_script(script)
        turns = turns[1:]
    for turn in turns:
        if turn == "script":
            meshlab.apply_script()
            for size in sizes:
                apply(size)
        else:
            # Reopened each time: Apply starts from the mesh at the opening of the dialog.
            dialog = meshlab.open_filter(*MENU)
            dialog.show_advanced()
            dialog.set_value(dialog.rows()[PARAMETERS.index("steps")], "1")
            dialog.apply()
            dialog.close()
            sizes.append(default_feature_size(ms))
            apply(sizes[-1])
    assert_same_in_floats(saved_vertices(meshlab), vertices(ms))


def test_a_selection_made_in_meshlab_is_filtered_with_every_option_for_parts(
    with_selection: MeshLab, bunny: Path
) -> None:
    dialog = with_selection.open_filter(*MENU)
    rows = dict(zip(PARAMETERS, dialog.rows(), strict=True))
    assert rows["selected"].showing
    assert rows["selected"].editors[-1].checked
    dialog.show_advanced()
    # Weights come from the quality, which a preview of the details replaces for a while.
    chosen = {
        "filter_type": "custom",
        "transfer_function": "20%:1, 8%:0.2",
        "crease_angle": "60",
        "preserve_volume": "true",
        "weight": "vertex quality",
        "result": "details",
    }
    for name, value in chosen.items():
        dialog.set_value(rows[name], value)
    dialog.preview(True)
    dialog.preview(False)
    dialog.set_value(rows["result"], "filtered shape")
    log = dialog.apply()
    dialog.close()
    assert "1 with the volume preserved" in log
    saved = with_selection.home / "part.ply"
    with_selection.save_mesh(saved)

    ms, before = load(bunny), vertices(load(bunny))
    ms.compute_selection_by_condition_per_face(condselect=HEAD)
    faces = ms.current_mesh().face_selection_array()
    ms.apply_filter(
        FILTER,
        filter_type="custom",
        transfer_function="20%:1, 8%:0.2",
        crease_angle=60.0,
        preserve_volume=True,
        weight="vertex quality",
    )
    in_meshlab, was = load(saved), load(bunny)
    mesh = in_meshlab.current_mesh()
    after = mesh.vertex_matrix()
    assert np.abs(after - vertices(ms)).max() <= 1e-6 * diagonal(before)
    weights = was.current_mesh().vertex_scalar_array().astype(np.float32)
    np.testing.assert_array_equal(mesh.vertex_scalar_array().astype(np.float32), weights)
    moved = np.any(after != before, axis=1)
    head = np.unique(mesh.face_matrix()[faces])
    assert 0.02 < len(head) / len(before) < np.mean(moved) < 0.5
    assert np.mean(moved[head]) > 0.9


def test_apply_logs_the_report_and_the_saved_mesh_is_that_of_pymeshlab(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path
) -> None:
    log = dialog.apply()
    dialog.close()
    ms = load(bunny)
    report = ms.apply_filter(FILTER)
    assert f"low-pass at feature size {report['feature_size']:.4g}" in log
    first = next(line for line in log.splitlines() if "Smoothed: " in line)
    assert f" on average, {report['max_displacement']:.2g} at most (" in first
    assert first.endswith(" s.")
    assert f"steps: automatic, {report['steps']} in pass {report['passes']}," in log
    assert f"area: {report['area_before']:.4g} -> {report['area_after']:.4g}" in log
    assert_same_in_floats(saved_vertices(meshlab), vertices(ms))


def test_a_refused_parameter_or_a_field_without_a_number_is_named_and_the_mesh_is_unchanged(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path
) -> None:
    row = dialog.rows()[PARAMETERS.index("stop_gain")]
    dialog.set_value(row, "-1")
    message = dialog.fail()
    assert "stop_gain = -1" in message
    assert MENU[-1] in message
    dialog.set_value(row, "0")
    dialog.show_advanced()
    dialog.set_value(dialog.rows()[PARAMETERS.index("steps")], "2.5")
    assert '"2.5" is not a number that can be used here' in dialog.fail()
    dialog.close()
    np.testing.assert_array_equal(saved_vertices(meshlab), vertices(load(bunny)))


def test_a_decimal_comma_is_a_point(dialog: FilterDialog, desktop: Desktop) -> None:
    for name, typed, read in (("stop_gain", "0,25", 0.25), ("feature_size", "7,5", 7.5)):
        editor = dialog.rows()[PARAMETERS.index(name)].editors[-1]
        wait_for(f"{name} to have the keys", lambda editor=editor: dialog.focus(editor))
        desktop.press_keys("ctrl+a")
        desktop.type(typed)
        desktop.press_keys("Tab")
        wait_for("the number", lambda editor=editor, read=read: float(editor.text) == read)


def test_percentages_are_those_of_the_mesh_after_a_preview_that_was_switched_off(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path
) -> None:
    size = PARAMETERS.index("feature_size")
    dialog.set_value(dialog.rows()[size], "60")
    dialog.preview(True)
    dialog.preview(False)
    dialog.close()
    length, percent = meshlab.open_filter(*MENU).rows()[size].editors
    share = float(length.text) / diagonal(vertices(load(bunny)))
    assert float(percent.text) == pytest.approx(100 * share, rel=1e-3)


def test_details_are_shown_in_colours_whose_range_is_logged(
    dialog: FilterDialog, meshlab: MeshLab, bunny: Path
) -> None:
    dialog.show_advanced()
    dialog.set_value(dialog.rows()[PARAMETERS.index("result")], "details")
    log = dialog.apply()
    dialog.close()
    assert "colours: blue -" in log
    saved = meshlab.home / "details.ply"
    meshlab.save_mesh(saved)
    vertex = plyfile.PlyData.read(saved)["vertex"]
    assert len(np.unique([vertex["red"], vertex["blue"]], axis=1).T) > 100


@pytest.mark.parametrize(
    ("menu", "name"),
    [("Filter (Fractional)", "caricature"), ("Equalizer", "relief"), ("Denoise", "teeth")],
)
def test_a_preset_fills_the_fields_and_is_previewed_once(
    meshlab: MeshLab, bunny: Path, menu: str, name: str
) -> None:
    ((of, options),) = ((of, options) for one, of, _, options in presets() if one == name)
    dialog = meshlab.open_filter(MENU[0], f"Spectral {menu}")
    dialog.preview(True)
    logged = len(meshlab.log())
    dialog.start_from(name)
    dialog.wait_for_result(logged)
    call = dialog.pymeshlab_call()
    assert meshlab.log()[logged:].count("Applied filter: ") == 1
    ms = load(bunny)
    percent = {"%": 1, "e": 100 * mean_edge(ms) / diagonal(vertices(ms))}
    (contract,) = (one for one in filters() if one["python_name"] == of)
    parameters = {one["name"]: one for one in contract["parameters"]}

    def compare(**given: Any) -> None:
        wanted = {
            key: parameters[key]["choices"].index(value)
            if parameters[key]["kind"] == "choice"
            else float(value[:-1]) * percent[value[-1]]
            if parameters[key]["kind"] == "length"
            else value
            for key, value in options.items()
        }
        usual = {key: parameters[key]["default"] for key in options}
        found = {key: getattr(value, "value", lambda v=value: v)() for key, value in given.items()}
        changed = {key: value for key, value in wanted.items() if value != usual[key]}
        assert found == pytest.approx(changed, rel=2e-3)  # the dialog's percentages are rounded

    exec(call, {"ms": SimpleNamespace(**{of: compare}), "pymeshlab": pymeshlab})
    dialog.start_from("defaults")
    wait_for("another call", lambda: dialog.pymeshlab_call() != call)
