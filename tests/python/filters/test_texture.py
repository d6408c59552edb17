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


def cylinder(radius: float, waves: int, amplitude: float) -> tuple[Array, NDArray[Any]]:
    """An open cylinder of waves around it."""
    around, along = 360, 120
    angle, z = np.meshgrid(
        2 * np.pi * np.arange(around) / around, np.linspace(0, 4 * radius, along), indexing="ij"
    )
    r = radius + amplitude * np.cos(waves * angle)
    V = np.column_stack([(r * np.cos(angle)).ravel(), (r * np.sin(angle)).ravel(), z.ravel()])
    i, j = np.meshgrid(np.arange(around), np.arange(along - 1), indexing="ij")
    a = (i * along + j).ravel()
    b = ((i + 1) % around * along + j).ravel()
    return V, np.vstack([np.column_stack([a, b, b + 1]), np.column_stack([a, b + 1, a + 1])])


@pytest.mark.parametrize("waves", [4, 6, 8, 16])
def test_a_fitted_cylinder_makes_cutoffs_near_its_radius_exact(waves: int) -> None:
    radius, amplitude = 3.0, 0.002
    V, F = cylinder(radius, waves, amplitude)
    length = 2 * np.pi * radius / waves
    for form, error in (("cylinder", 0.004), ("size", None)):
        texture = surface_texture(V, F, waviness=length, form=form, crease_angle=180)
        if error is None:  # coordinates turn around the axis: the closed form of the reference
            gains = [1 - 2.0 ** -(((waves + k) / waves) ** 2) for k in (1, -1)]
            kept = ((1 - 1 / waves) * gains[0] + (1 + 1 / waves) * gains[1]) / 2
            left = 1 - 2.0 ** -(8.0**2)
            assert texture.Sq == pytest.approx(kept * left * amplitude / np.sqrt(2), rel=0.02)
        else:
            assert texture.form_radius == pytest.approx(radius, rel=1e-4)
            assert texture.Sq == pytest.approx(0.5 * amplitude / np.sqrt(2), rel=2 * error)


def test_without_an_l_filter_all_of_the_deviation_from_a_plane_is_measured() -> None:
    V, F = square("fine")
    texture = surface_texture(waves(V), F, waviness="100%", form="plane", crease_angle=180)
    assert texture.waviness == texture.vertices_left_out == 0
    # Both waves whole.
    assert texture.Sq == pytest.approx(0.004, rel=0.02)


def test_only_the_selection_is_measured() -> None:
    V, F = square("fine")
    chosen = V[:, 0] > 6
    rough = waves(V) * [1, 1, 0]
    rough[chosen] = waves(V)[chosen]
    texture = surface_texture(rough, F, waviness=3.0, selection=chosen)
    assert not texture.height[~chosen].any()
    whole = surface_texture(rough, F, waviness=3.0)
    np.testing.assert_array_equal(texture.height[chosen], whole.height[chosen])
    assert texture.vertices_evaluated < whole.vertices_evaluated
    assert texture.Sq > whole.Sq


def test_histogram_and_bearing_curve_are_those_of_the_heights() -> None:
    V, F = square("fine")
    texture = surface_texture(waves(V), F, waviness=3.0)
    h = texture.height[texture.height != 0]
    assert texture.histogram_shares.sum() == pytest.approx(1)
    counts, edges = np.histogram(h, bins=64)  # the areas are all but equal
    np.testing.assert_allclose(texture.histogram_shares, counts / len(h), atol=2e-3)
    np.testing.assert_allclose(texture.histogram_heights, (edges[1:] + edges[:-1]) / 2, rtol=1e-9)
    exceeded = np.quantile(h, 1 - np.arange(101) / 100)
    np.testing.assert_allclose(texture.bearing_heights, exceeded, atol=0.01 * texture.Sz)
    assert texture.bearing_heights[0] == texture.Sp
    assert texture.bearing_heights[-1] == -texture.Sv


def test_meshlab_gets_the_same_heights_as_quality_and_colours() -> None:
    V, F = square("square")
    V = waves(V)
    mesh_set = mesh_set_of(V, F)
    report = mesh_set.apply_filter(TEXTURE, waviness=pymeshlab.PureValue(3.0))
    texture = surface_texture(V, F, waviness=3.0)
    mesh = mesh_set.current_mesh()
    np.testing.assert_array_equal(mesh.vertex_scalar_array(), texture.height)
    np.testing.assert_array_equal(mesh.vertex_matrix(), V)
    assert report.keys() | {"warnings"} == texture.report.keys()
    for name, value in report.items():
        np.testing.assert_array_equal(value, texture.report[name], err_msg=name)
    high = texture.height > 0.004
    assert (mesh.vertex_color_matrix()[high, 0] == 1).all()
    assert (mesh.vertex_color_matrix()[high, 2] < 1).all()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"waviness": 0.0}, "waviness"),
        ({"waviness": 1.0, "noise": 2.0}, "noise"),
        ({"waviness": 1.0, "form_size": 0.5}, "form_size"),
        ({"waviness": 1.0, "form": "cone"}, "form"),
        ({"waviness": 1.0, "selected": True}, "selection"),
        ({"crease_angle": 200.0}, "crease_angle"),
        ({"cutoff": 1.0}, "cutoff"),
        ({"waviness": 9.0}, "whole surface"),
    ],
)
def test_what_does_not_fit_is_named(options: dict[str, Any], said: str) -> None:
    V, F = square("square")
    with pytest.raises(OptionError, match=said):
        surface_texture(V, F, **options)
