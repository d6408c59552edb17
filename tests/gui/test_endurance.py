"""Many previews in a row: MeshLab keeps running, and its memory does not grow."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from statistics import median

from filter_dialog import FilterDialog
from fractional import PARAMETERS
from meshlab import MeshLab

PREVIEWS, WARM_UP = 50, 10
# Measured: 8 to 10. Of these, 6.6 are MeshLab's own: after every preview it recreates icons and
# menus, and keeps the old ones. Live memory after all previews is, to 0.01, that after as many of a
# filter that does nothing; the rest is fragmentation of the heap, which levels off. A filter that
# leaks 0.5 per preview takes 27, one that leaks the GL context that MeshLab makes for it, hundreds.
MEBIBYTES_ALLOWED = 13.0


def mebibytes_taken(pid: int) -> float:
    """Memory that a process has obtained for data, in use or free for reuse.

    Unlike the resident part, this does not grow when MeshLab reuses pages of its heap that were
    freed long ago.
    """
    status = Path(f"/proc/{pid}/status").read_text()
    (kibibytes,) = re.findall(r"^VmData:\s+(\d+) kB$", status, re.MULTILINE)
    return int(kibibytes) / 1024


def test_fifty_previews_need_no_more_memory_than_the_first_ten(
    dialog: FilterDialog, meshlab: MeshLab, record_property: Callable[[str, object], None]
) -> None:
    dialog.show_advanced()
    rows = dict(zip(PARAMETERS, dialog.rows(), strict=True))
    dialog.set_value(rows["steps"], "1")
    dialog.preview(True)
    taken = []
    for i in range(PREVIEWS):
        before = len(meshlab.log())
        dialog.set_value(rows["feature_size"], str(2 + i % WARM_UP))
        dialog.wait_for_result(before)
        assert dialog.window.showing  # MeshLab answers once it has finished the work after a filter
        taken.append(mebibytes_taken(meshlab.pid))
    record_property("MiB taken after each preview", taken)
    # Medians: the heap grows in jumps, when a preview does not fit into free memory.
    grown = median(taken[-WARM_UP:]) - median(taken[WARM_UP : 2 * WARM_UP])
    assert grown < MEBIBYTES_ALLOWED, taken
