"""How long a preview takes in MeshLab, from the tick to the last change of the picture; not tests.

Run by pytest for its fixtures: `tests/gui/run.sh -s tests/gui/bench_preview.py`.
"""

from __future__ import annotations

import pathlib
import re
import time

import numpy as np
from accessibility import Box
from desktop import Desktop, save_picture
from filter_dialog import FilterDialog
from meshlab import MeshLab

RUNS = 5
LONGEST = 2.0  # seconds; the preview is shown by then
OUTPUT = pathlib.Path("build/gui")


def test_preview(dialog: FilterDialog, meshlab: MeshLab, desktop: Desktop) -> None:
    dialog.move(1000, 20)
    window = meshlab.main_window().box
    scene = Box(window.x, window.y + 100, dialog.window.box.x - window.x, 500)
    box = dialog.window.find("check box", "Preview")
    assert box is not None
    for _ in range(RUNS):
        shown = desktop.settled_picture(scene)
        logged = len(meshlab.log())
        seconds = 0.0
        start = time.perf_counter()
        box.press()
        while time.perf_counter() - start < LONGEST:
            picture = desktop.picture(scene)
            if not np.array_equal(picture, shown):
                seconds, shown = time.perf_counter() - start, picture
            time.sleep(0.002)
        (milliseconds,) = re.findall(r"Applied filter: .* in (\d+) msec", meshlab.log()[logged:])
        print(f"\nlast change after {seconds:.3f} s, of them the filter {milliseconds} ms")
        save_picture(shown, OUTPUT / "bench_preview.png")
        dialog.preview(False)
