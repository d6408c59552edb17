"""How long a preview takes in MeshLab, from the tick to the picture; no tests.

Run by pytest for its fixtures: `tests/gui/run.sh -s tests/gui/bench_preview.py`.
"""

from __future__ import annotations

import re
import time

from accessibility import Box
from desktop import Desktop
from filter_dialog import FilterDialog
from meshlab import MeshLab
from waiting import wait_for

RUNS = 5


def test_preview(dialog: FilterDialog, meshlab: MeshLab, desktop: Desktop) -> None:
    dialog.move(1000, 20)
    window = meshlab.main_window().box
    scene = Box(window.x, window.y + 100, dialog.window.box.x - window.x, 500)
    box = dialog.window.find("check box", "Preview")
    assert box is not None
    for _ in range(RUNS):
        before = desktop.settled_picture(scene)
        logged = len(meshlab.log())
        start = time.perf_counter()
        box.press()
        while (desktop.picture(scene) == before).all():
            time.sleep(0.005)
        seconds = time.perf_counter() - start
        wait_for("the log", lambda at=logged: "Applied filter" in meshlab.log()[at:])
        (milliseconds,) = re.findall(r"Applied filter: .* in (\d+) msec", meshlab.log()[logged:])
        print(f"\npicture after {seconds:.3f} s, of them the filter {milliseconds} ms")
        dialog.preview(False)
