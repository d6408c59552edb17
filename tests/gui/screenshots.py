"""The pictures of MeshLab in screenshots/ with their numbers, by `make screenshots`; not tests.

Run by pytest for its fixtures: the screen, and MeshLab with the plugin installed.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from accessibility import Box
from desktop import Desktop, Picture, save_picture
from figure_numbers import record
from meshlab import MeshLab
from shown import BUST, DRAGON, FEATURE_SIZE, GAINS, MODE, PICTURES
from shown import MENU as SMOOTHING
from waiting import wait_for

REPOSITORY = Path(__file__).resolve().parents[2]
SCREENSHOTS = REPOSITORY / "screenshots"
DATA = Path(os.environ.get("MESHLAB_SPECTRAL_DATA") or REPOSITORY.parent / "shared" / "data")

FILTER = "Spectral Filter (Fractional)"
MEASURES = "Quality Measure and Computations"


def middle_of(meshlab: MeshLab) -> Box:
    """The part of the screen with the mesh, without what MeshLab writes below it."""
    window = meshlab.main_window().box
    return Box(window.x + 2, window.y + 100, 1000, 740)


def save(picture: Picture, name: str) -> None:
    """Save a picture, and record the numbers of what it shows."""
    path = SCREENSHOTS / f"{name}.png"
    save_picture(picture, path)
    record(path, PICTURES[name](DATA.joinpath))


def test_the_menu(meshlab: MeshLab, desktop: Desktop) -> None:
    path = ("Filters", SMOOTHING, FILTER)
    for depth in range(1, len(path) + 1):
        entry = meshlab.menu_entry(*path[:depth])
        assert entry is not None
        wait_for(f"{entry} on the screen", lambda entry=entry: entry.box.width > 0)
        if depth == len(path):
            desktop.point_at(entry.box)
        else:
            desktop.click(entry.box)
    desktop.settled_picture(middle_of(meshlab))
    save(desktop.picture(), "meshlab_menu")


def test_the_dialog(meshlab: MeshLab, desktop: Desktop) -> None:
    dialog = meshlab.open_filter(SMOOTHING, FILTER)
    dialog.move(1020, 60)
    dialog.preview(True)
    desktop.settled_picture(middle_of(meshlab))
    save(desktop.picture(), "meshlab_dialog")


def test_the_dialog_with_a_selection(with_selection: MeshLab, desktop: Desktop) -> None:
    dialog = with_selection.open_filter(SMOOTHING, FILTER)
    dialog.move(1020, 60)
    dialog.set_value(dialog.rows()[1], str(FEATURE_SIZE))
    dialog.preview(True)
    desktop.settled_picture(middle_of(with_selection))
    save(desktop.picture(), "meshlab_selection")


def test_the_dragon_before_and_after(
    install: Callable[[], None], start: Callable[[Path], MeshLab], home: Path, desktop: Desktop
) -> None:
    dragon = DATA / DRAGON
    if not dragon.is_file():
        pytest.skip(f"no {dragon.name} in the collection of meshes")
    install()
    meshlab = start(Path(shutil.copy(dragon, home)))
    window = meshlab.main_window().box
    scene = Box(window.x + 200, window.y + 270, 720, 490)  # where the dragon is seen
    before = desktop.settled_picture(scene)
    dialog = meshlab.open_filter(SMOOTHING, FILTER)
    dialog.apply()
    dialog.close()
    both = np.concatenate([before, desktop.settled_picture(scene)], axis=1)
    save(both, "meshlab_dragon_before_after")


def test_a_scan_before_and_with_the_preview_of_denoising(
    install: Callable[[], None],
    start: Callable[[Path], MeshLab],
    noisy_bunny: Path,
    desktop: Desktop,
) -> None:
    install()
    meshlab = start(noisy_bunny)
    dialog = meshlab.open_filter(SMOOTHING, "Spectral Denoise")
    dialog.move(1020, 170)
    dialog.show_advanced()
    window = meshlab.main_window().box
    scene = Box(window.x + 285, window.y + 150, 560, 730)  # where the bunny is seen
    before = desktop.settled_picture(scene)
    dialog.preview(True)
    desktop.settled_picture(scene)
    after = desktop.picture(scene._replace(width=window.x + window.width - scene.x))
    save(np.concatenate([before, after], axis=1), "meshlab_denoise")


def test_a_bust_before_and_after_the_equalizer(
    install: Callable[[], None], start: Callable[[Path], MeshLab], home: Path, desktop: Desktop
) -> None:
    bust = DATA / BUST
    if not bust.is_file():
        pytest.skip(f"no {bust.name} in the collection of meshes")
    install()
    meshlab = start(Path(shutil.copy(bust, home)))
    dialog = meshlab.open_filter(SMOOTHING, "Spectral Equalizer")
    dialog.move(1020, 170)
    window = meshlab.main_window().box
    scene = Box(window.x + 285, window.y + 150, 560, 730)  # where the bust is seen
    before = desktop.settled_picture(scene)
    for row, gain in zip(dialog.rows(), GAINS, strict=False):
        dialog.set_value(row, f"{gain:g}")
    dialog.apply()  # a preview is a draft
    desktop.settled_picture(scene)
    after = desktop.picture(scene._replace(width=window.x + window.width - scene.x))
    save(np.concatenate([before, after], axis=1), "meshlab_equalizer")


def test_a_manifold_harmonic(meshlab: MeshLab, desktop: Desktop) -> None:
    dialog = meshlab.open_filter(MEASURES, "Manifold Harmonics")
    mode = next(row for row in dialog.rows() if row.label == "Mode")
    dialog.set_value(mode, str(MODE))
    dialog.apply()
    dialog.close()
    desktop.settled_picture(middle_of(meshlab))
    save(desktop.picture(), "meshlab_harmonic")
