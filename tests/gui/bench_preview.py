"""How long a preview takes in MeshLab, from the key to the last change of the picture; not tests.

Run by pytest for its fixtures: `BENCH_MESH=FILE tests/gui/run.sh -s tests/gui/bench_preview.py`, by
default with the bunny.
"""

from __future__ import annotations

import os
import pathlib
import re
import time
from collections.abc import Callable

import numpy as np
import pytest
from accessibility import Box, Widget
from desktop import Desktop, Picture, save_picture
from filter_dialog import FilterDialog
from fractional import load, save_shape
from meshlab import MeshLab
from scene import scene_of
from waiting import wait_for

SMOOTHING = "Smoothing, Fairing and Deformation"
RUNS = 5
STILL = 2.0  # seconds without a change after the filter: the preview is shown
OUTPUT = pathlib.Path("build/gui")


@pytest.fixture
def opened(
    install: Callable[[], None], start: Callable[[pathlib.Path], MeshLab], bunny: pathlib.Path
) -> MeshLab:
    """A MeshLab with the mesh."""
    save_shape(load(pathlib.Path(os.environ.get("BENCH_MESH") or bunny)), bunny)
    install()
    return start(bunny)


def seconds_until_shown(
    meshlab: MeshLab, desktop: Desktop, scene: Box, act: Callable[[], None]
) -> tuple[float, float, Picture]:
    """Act; return the seconds until the last change, those of the filter, and the picture."""
    shown = desktop.settled_picture(scene)
    logged = len(meshlab.log())
    start = last = time.perf_counter()
    act()
    done: list[str] = []
    waited_from = start
    while not done or time.perf_counter() - waited_from < STILL:
        picture = desktop.picture(scene)
        if not np.array_equal(picture, shown):
            last = waited_from = time.perf_counter()
            shown = picture
        if not done:
            done = re.findall(r"Applied filter: .* in (\d+) msec", meshlab.log()[logged:])
            waited_from = time.perf_counter()
        time.sleep(0.002)
    return last - start, float(done[-1]) / 1000, shown


def report(what: str, seconds: float, of_filter: float, picture: Picture, name: str) -> None:
    print(f"\n{what}: last change after {seconds:.3f} s, of them the filter {of_filter:.3f} s")
    save_picture(picture, OUTPUT / f"bench_{name}.png")


def test_preview(opened: MeshLab, desktop: Desktop) -> None:
    dialog = opened.open_filter(SMOOTHING, "Spectral Filter (Fractional)")
    dialog.move(1000, 20)
    scene = scene_of(opened, dialog)
    box = dialog.window.find("check box", "Preview")
    assert box is not None
    for _ in range(RUNS):
        report("Preview", *seconds_until_shown(opened, desktop, scene, box.press), "preview")
        dialog.preview(False)


def test_slider(opened: MeshLab, desktop: Desktop) -> None:
    dialog = opened.open_filter(SMOOTHING, "Spectral Equalizer")
    dialog.move(1000, 20)
    scene = scene_of(opened, dialog)
    dialog.preview(True)
    slider = visible_slider(dialog)
    wait_for("the slider to have the keys", lambda: dialog.focus(slider))
    for run in range(RUNS):
        key = ("Prior", "Next")[run % 2]  # twice the details, and back
        shown = seconds_until_shown(opened, desktop, scene, lambda key=key: desktop.press_keys(key))
        report("the first slider's move" if run == 0 else "the next one", *shown, "slider")


def visible_slider(dialog: FilterDialog) -> Widget:
    """The slider of details of four times the smallest size."""
    return [slider for slider in dialog.sliders() if slider.showing][3]
