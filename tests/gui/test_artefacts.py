"""Spectral Artefacts in MeshLab's dialog: one scale for all meshes; a good one stays white."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import plyfile
import pytest
from desktop import Desktop
from fractional import FILTER as LOW_PASS
from fractional import default_feature_size, load, save_shape
from meshlab import MeshLab
from scene import scene_of

MENU = ("Quality Measure and Computations", "Spectral Artefacts")
FILTER = "compute_scalar_spectral_artefacts_per_vertex"


@pytest.mark.parametrize("is_smooth", [True, False])
def test_a_smooth_mesh_stays_white_and_a_noisy_one_does_not(
    install: Callable[[], None],
    start: Callable[[Path], MeshLab],
    desktop: Desktop,
    noisy_bunny: Path,
    *,
    is_smooth: bool,
) -> None:
    mesh_set = load(noisy_bunny)
    if is_smooth:
        mesh_set.apply_filter(LOW_PASS)
        save_shape(mesh_set, noisy_bunny)
        mesh_set = load(noisy_bunny)
    size = default_feature_size(mesh_set)
    report = mesh_set.apply_filter(FILTER)
    lengths = mesh_set.current_mesh().vertex_scalar_array()

    install()
    meshlab = start(noisy_bunny)
    dialog = meshlab.open_filter(*MENU)
    dialog.move(1000, 20)
    scene = scene_of(meshlab, dialog)
    before = desktop.settled_picture(scene).astype(int)
    log = dialog.apply()
    after = desktop.settled_picture(scene).astype(int)
    dialog.close()

    # The scale is that of the feature size, not the mesh's own largest artefact.
    (full,) = re.findall(r"colours: white 0, dark red (\S+) and more, a tenth of the", log)
    assert float(full) == pytest.approx(0.1 * size, rel=0.01)
    assert f"largest {report['maximum']:.4g}"[:-1] in log

    # Where it turned coloured: red exceeds blue there.
    colored = (after[..., 0] - after[..., 2] > 60) & (np.abs(after - before).max(axis=2) > 8)
    share = float(colored.mean())
    expected = float((lengths > 0.02 * size).mean())
    assert (share < 0.002 and expected < 0.01) if is_smooth else (share > 0.03 and expected > 0.1)

    saved = meshlab.home / "artefacts.ply"
    meshlab.save_mesh(saved)
    shown = plyfile.PlyData.read(saved)["vertex"]["quality"]
    # MeshLab has coordinates in single precision, which the small artefacts are differences of.
    np.testing.assert_allclose(shown, lengths, rtol=0, atol=1e-5 * size)
