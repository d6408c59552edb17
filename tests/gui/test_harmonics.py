"""Manifold Harmonics in MeshLab's dialog: one mode after the other."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import plyfile
from fractional import load
from meshlab import MeshLab

MENU = ("Quality Measure and Computations", "Manifold Harmonics")
FILTER = "compute_scalar_manifold_harmonic_per_vertex"


def test_modes_shown_one_after_the_other_are_those_of_runs_of_their_own(
    install: Callable[[], None], start: Callable[[Path], MeshLab], bunny: Path
) -> None:
    install()
    meshlab = start(bunny)
    dialog = meshlab.open_filter(*MENU)
    for mode in (1, 7):
        dialog.set_value(dialog.rows()[0], str(mode))
        log = dialog.apply()
        assert f"Manifold Harmonics: mode {mode} of 100" in log
        assert ("quality_before" in log) == (mode == 7)
    dialog.close()
    saved = meshlab.home / "harmonic.ply"
    meshlab.save_mesh(saved)
    shown = plyfile.PlyData.read(saved)["vertex"]["quality"]
    mesh_set = load(bunny)
    mesh_set.apply_filter(FILTER, mode=7)
    expected = mesh_set.current_mesh().vertex_scalar_array()
    np.testing.assert_allclose(shown, expected, atol=1e-6 * np.abs(expected).max())
