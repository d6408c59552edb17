"""`max_displacement`: no vertex moves farther, and no ridge is left."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from meshlab_spectral import denoise_mesh, filter_mesh
from meshlab_spectral.errors import OptionError
from meshlab_spectral.files.meshes import load_arrays
from numpy.typing import NDArray
from shapes import sphere
from shared_types import SharedMesh

Array = NDArray[np.float64]


def noisy_sphere() -> tuple[Array, NDArray[Any]]:
    """A sphere of radius 1, with noise of a fifth of an edge along its normals."""
    V, F = sphere(5)
    noise = 0.007 * np.random.default_rng(3).standard_normal(len(V))
    return V * (1 + noise)[:, None], F


def normals(V: Array, F: NDArray[Any]) -> Array:
    a, b, c = (V[F[:, corner]] for corner in range(3))
    N = np.cross(b - a, c - a)
    return N / np.linalg.norm(N, axis=1)[:, None]


def angle(A: Array, B: Array, F: NDArray[Any]) -> float:
    """Mean angle between the normals of two shapes, degrees."""
    cosines = np.clip((normals(A, F) * normals(B, F)).sum(axis=1), -1, 1)
    return float(np.degrees(np.arccos(cosines)).mean())


@pytest.mark.parametrize("bound", [0.002, 0.01])
def test_no_vertex_moves_farther(bound: float) -> None:
    V, F = noisy_sphere()
    for done in (
        filter_mesh(V, F, feature_size=0.6, max_displacement=bound),
        denoise_mesh(V, F, max_displacement=bound),
    ):
        moved, report = done
        largest = np.linalg.norm(moved - V, axis=1).max()
        assert largest <= bound * (1 + 1e-9)
        assert report["max_displacement"] <= bound * (1 + 1e-9)
        assert 0 < report["limited_share"] <= 1


def crown() -> tuple[Array, NDArray[Any]]:
    """A tooth: four cusps and the grooves between them, on a rounded block."""
    V, F = sphere(5)
    d = V / np.linalg.norm(V, axis=1)[:, None]
    azimuth, across = np.arctan2(d[:, 1], d[:, 0]), np.hypot(d[:, 0], d[:, 1])
    cusps = 0.36 * np.maximum(d[:, 2], 0) * across**2 * np.cos(4 * azimuth)
    return d * (1 + cusps)[:, None] * [1, 0.85, 0.7], F


@pytest.mark.parametrize("name", ["fandisk.off", "crown", "lionstatue.obj"])
def test_a_bound_of_three_noise_heights_costs_no_normals(
    name: str, shared_mesh: SharedMesh
) -> None:
    """On a part by CAD, a tooth and a statue, with noise of a fifth of an edge."""
    truth, F = crown() if name == "crown" else load_arrays(shared_mesh(name))
    height = 0.2 * np.linalg.norm(truth[F] - truth[np.roll(F, 1, 1)], axis=2).mean()
    corners = truth[F].swapaxes(0, 1)
    areas = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    N = np.zeros_like(truth)
    np.add.at(N, F, areas[:, None])
    N /= np.linalg.norm(N, axis=1)[:, None]
    V = truth + height * np.random.default_rng(1).normal(size=(len(N), 1)) * N
    free, report = denoise_mesh(V, F)
    bound = 3 * report["noise_height"]
    assert report["max_displacement"] > bound
    bounded, report = denoise_mesh(V, F, max_displacement=bound)
    assert angle(bounded, truth, F) <= angle(free, truth, F) + 0.5
    assert np.linalg.norm(bounded - V, axis=1).max() <= bound * (1 + 1e-9)
    assert 0 < report["limited_share"] < 0.01


def test_a_bound_that_is_not_reached_changes_nothing() -> None:
    V, F = noisy_sphere()
    free, report = filter_mesh(V, F, feature_size=0.3)
    bounded, other = filter_mesh(
        V, F, feature_size=0.3, max_displacement=2 * report["max_displacement"]
    )
    assert (free == bounded).all()
    assert report["limited_share"] == other["limited_share"] == 0


def test_edges_and_percent_are_lengths_of_the_mesh() -> None:
    V, F = noisy_sphere()
    diagonal = np.linalg.norm(np.ptp(V, axis=0))
    moved, _ = filter_mesh(V, F, feature_size=0.6, max_displacement="0.1%")
    assert np.linalg.norm(moved - V, axis=1).max() <= 1e-3 * diagonal * (1 + 1e-6)
    with pytest.raises(OptionError, match="max_displacement"):
        filter_mesh(V, F, max_displacement=-1)
