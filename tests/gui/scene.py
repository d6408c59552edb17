"""The mesh on the screen: where it is, and how much of it has changed."""

from __future__ import annotations

import numpy as np
from accessibility import Box
from desktop import Picture
from filter_dialog import FilterDialog
from meshlab import MeshLab


def scene_of(meshlab: MeshLab, dialog: FilterDialog) -> Box:
    """The part of the screen with the mesh: without the frame rate, which always changes."""
    window = meshlab.main_window().box
    top = window.y + window.height // 8
    return Box(window.x, top, dialog.window.box.x - window.x, window.height * 3 // 4 - top)


def share_changed(before: Picture, after: Picture) -> float:
    """The share of the pixels whose colour has changed visibly."""
    return float((np.abs(after.astype(int) - before).max(axis=2) > 8).mean())
