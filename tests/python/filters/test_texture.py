"""`surface_texture`: independent of the meshing, and the same as in MeshLab."""

from __future__ import annotations

from typing import Any

import numpy as np
import pymeshlab
import pytest
import pyvista
from helpers import mesh_set_of
from meshlab_spectral import OptionError, surface_texture
from numpy.typing import NDArray

Array = NDArray[np.float64]
TEXTURE = "compute_scalar_surface_texture_per_vertex"


def waves(V: Array) -> Array:
    """Heights of two crossing waves of lengths 1 and 1.4 on the plane."""
    x, y = V[:, 0], V[:, 1]
    z = np.cos(2 * np.pi * (0.8 * x + 0.6 * y)) + np.cos(2 * np.pi * (0.5 * x - 0.5 * y))
    return np.column_stack([x, y, 0.004 * z])


def square(kind: str) -> tuple[Array, NDArray[Any]]:
    """A square of 12 units, in one of several meshings."""
    if kind == "random":
        P = np.random.default_rng(2).uniform(0, 12, (26000, 2))
        rim = np.linspace(0, 12, 140)
        edges = [np.column_stack(pair) for pair in ((rim, 0 * rim), (rim, 0 * rim + 12))]
        P = np.vstack([P, *edges, *(one[:, ::-1] for one in edges)])
        cloud = pyvista.PolyData(
            np.column_stack([np.unique(P, axis=0), 0 * np.unique(P, axis=0)[:, 0]])
        )
        mesh = cloud.delaunay_2d()
        return np.asarray(mesh.points, dtype=np.float64), mesh.regular_faces
    i, j = {"square": (170, 170), "stretched": (300, 150), "fine": (280, 280)}[kind]
    grid = pyvista.Plane(center=(6, 6, 0), i_size=12, j_size=12, i_resolution=i, j_resolution=j)
    grid = grid.triangulate()
    return np.asarray(grid.points, dtype=np.float64), grid.regular_faces


@pytest.mark.parametrize("kind", ["square", "stretched", "fine", "random"])
def test_the_meshing_does_not_matter(kind: str) -> None:
    V, F = square(kind)
    texture = surface_texture(waves(V), F, waviness=3.0)
    # Both waves keep what the L-filter leaves of them.
    left = [1 - 2 ** -((3 / length) ** 2) for length in (1, np.sqrt(2))]
    exact = 0.004 * np.sqrt(sum(np.square(left)) / 2)
    assert texture.Sq == pytest.approx(exact, rel=0.01)
    assert texture.vertices_left_out > 0


def test_meshlab_gets_the_same_heights_as_quality_and_colours() -> None:
    V, F = square("square")
    V = waves(V)
    mesh_set = mesh_set_of(V, F)
    report = mesh_set.apply_filter(TEXTURE, waviness=pymeshlab.PureValue(3.0))
    texture = surface_texture(V, F, waviness=3.0)
    mesh = mesh_set.current_mesh()
    np.testing.assert_array_equal(mesh.vertex_scalar_array(), texture.height)
    np.testing.assert_array_equal(mesh.vertex_matrix(), V)
    assert {**report, "warnings": []} == texture.report
    high = texture.height > 0.004
    assert (mesh.vertex_color_matrix()[high, 0] == 1).all()
    assert (mesh.vertex_color_matrix()[high, 2] < 1).all()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"waviness": 0.0}, "waviness"),
        ({"waviness": 1.0, "noise": 2.0}, "noise"),
        ({"waviness": 1.0, "form": 0.5}, "form"),
        ({"crease_angle": 200.0}, "crease_angle"),
        ({"cutoff": 1.0}, "cutoff"),
        ({"waviness": 9.0}, "whole surface"),
    ],
)
def test_what_does_not_fit_is_named(options: dict[str, Any], said: str) -> None:
    V, F = square("square")
    with pytest.raises(OptionError, match=said):
        surface_texture(V, F, **options)
