"""Spectral Denoise in MeshLab's dialog, with its defaults."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from fractional import diagonal, load, mean_edge, save_shape, saved_vertices, vertices
from meshlab import MeshLab
from numpy.typing import NDArray

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


def test_where_ripples_are_not_noise_the_log_gives_values_that_remove_them(
    install: Callable[[], None], start: Callable[[Path], MeshLab], bunny: Path
) -> None:
    # Ripples of a fifth of an edge, four edges from crest to crest: visible, and as regular as a
    # shape is.
    mesh_set = load(bunny)
    mesh, edge, clean = mesh_set.current_mesh(), mean_edge(mesh_set), vertices(mesh_set)
    heights = 0.2 * edge * np.sin(2 * np.pi * clean[:, 1] / (4 * edge))
    normals = mesh.vertex_normal_matrix()
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    F = mesh.face_matrix()
    mesh_set.add_mesh(pymeshlab.Mesh(clean + heights[:, None] * normals, F))
    save_shape(mesh_set, bunny)
    rippled = vertices(load(bunny))

    install()
    meshlab = start(bunny)
    dialog = meshlab.open_filter(*MENU)
    log = dialog.apply()
    assert log.count("found no noise clearly distinct from the shape") == 1
    ((height, size),) = re.findall(r"ripples .*, try noise height (\S+) and noise size (\S+) ", log)
    assert float(height) == pytest.approx(0.1 * mean_edge(load(bunny)), rel=0.05)
    assert float(size) == pytest.approx(2 * mean_edge(load(bunny)), rel=0.05)

    # The values as they stand in the log, into the fields of these names.
    for row in dialog.rows():
        for label, value in (("Noise height", height), ("Noise size", size)):
            if row.label.startswith(label):
                dialog.set_value(replace(row, editors=row.editors[:1]), value)
    assert "as given: removed" in dialog.apply()
    dialog.close()
    smooth = saved_vertices(meshlab)
    before, after = (mean_angle(V, clean, F) for V in (rippled, smooth))
    assert after < 0.6 * before


def mean_angle(V: NDArray[np.float64], W: NDArray[np.float64], F: NDArray[np.int32]) -> float:
    """Return the mean angle between the normals of the same faces of two shapes, degrees."""

    def normals(X: NDArray[np.float64]) -> NDArray[np.float64]:
        crosses = np.cross(X[F[:, 1]] - X[F[:, 0]], X[F[:, 2]] - X[F[:, 0]])
        return np.asarray(crosses / np.linalg.norm(crosses, axis=1)[:, None])

    cosines = (normals(V) * normals(W)).sum(axis=1)
    return float(np.degrees(np.arccos(cosines.clip(-1, 1))).mean())
