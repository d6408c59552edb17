"""Spectral Denoise in MeshLab's dialog, with its defaults."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from fractional import diagonal, load, saved_vertices, vertices
from meshlab import MeshLab

MENU = ("Smoothing, Fairing and Deformation", "Spectral Denoise")


def test_a_scan_is_denoised_with_the_defaults(
    install: Callable[[], None], start: Callable[[Path], MeshLab], noisy_bunny: Path
) -> None:
    install()
    meshlab = start(noisy_bunny)
    noisy = vertices(load(noisy_bunny))
    dialog = meshlab.open_filter(*MENU)
    dialog.preview(True)
    dialog.preview(False)
    np.testing.assert_array_equal(saved_vertices(meshlab, "restored.ply"), noisy)
    log = dialog.apply()
    dialog.close()

    mesh_set = load(noisy_bunny)
    report = mesh_set.apply_filter("apply_coord_spectral_denoise")
    edges, height = report["noise_height"] / report["mean_edge"], report["noise_height"]
    assert f"white noise: height {edges:.2g} edges ({height:.3g}): removed" in log
    denoised = vertices(mesh_set)
    assert np.abs(denoised - noisy).max() > 1e-3 * diagonal(noisy)
    distance = np.abs(saved_vertices(meshlab, "denoised.ply") - denoised).max()
    assert distance <= 1e-6 * diagonal(noisy)
