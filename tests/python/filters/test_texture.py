"""`surface_texture`: independent of the meshing, and the same as in MeshLab."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
import pyvista
from helpers import mesh_set_of
from meshlab_spectral import OptionError, surface_texture
from numpy.typing import NDArray
from shapes import grid, quads

Array = NDArray[np.float64]
TEXTURE = "compute_scalar_surface_texture_per_vertex"
REFERENCE = Path(__file__).resolve().parents[3] / f"python/docs/filters/{TEXTURE}.rst"


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
    return V, quads(grid(around, along, 0))


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


def sphere_gain(degree: float, cutoff: float) -> float:
    """What a height of this degree keeps on the unit sphere, where coordinates turn with it.

    Along the normal, the coordinates of waves of degree l have the degrees l - 1 and l + 1; and
    waves scale the metric and with it the Laplacian, of which all coordinates, of degree 1, get
    some.
    """
    l = degree  # noqa: E741
    up = (l - 1) * (l + 1) * (l + 4) / (l * (l + 3) * (2 * l + 1))
    down = l * (l + 2) * (l - 3) / ((l - 2) * (l + 1) * (2 * l + 1))

    def low(k: float) -> float:
        return float(2.0 ** -(cutoff**2 * k * (k + 1) / (4 * np.pi**2)))

    return 1 - up * low(l + 1) - down * low(l - 1) - (1 - up - down) * low(1)


@pytest.mark.parametrize("length", [0.5, 1, 2, 4])
def test_a_sphere_transmits_waves_by_the_closed_form_or_fitted_as_the_standard(
    length: float,
) -> None:
    degree, amplitude = 12, 2e-4
    ball = pyvista.Icosphere(radius=1, nsub=6)
    V = np.asarray(ball.points, dtype=np.float64)
    V /= np.linalg.norm(V, axis=1, keepdims=True)
    P = V @ np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))[0]
    wave = np.hypot(P[:, 0], P[:, 1]) ** degree * np.cos(degree * np.arctan2(P[:, 1], P[:, 0]))
    cutoff = 2 * np.pi / np.sqrt(degree * (degree + 1)) / length
    rough = V * (1 + amplitude * wave)[:, None]
    gains = {}
    for form in ("size", "sphere"):
        height = surface_texture(rough, ball.regular_faces, waviness=cutoff, form=form).height
        gains[form] = height @ wave / (wave @ wave) / amplitude
    left = 1 - 2 ** -((8 / length) ** 2)  # of form_size
    assert gains["size"] == pytest.approx(left * sphere_gain(degree, cutoff), abs=0.003)
    assert gains["sphere"] == pytest.approx(1 - 2 ** -((1 / length) ** 2), abs=0.003)


def test_the_table_of_the_reference_is_that_of_the_closed_form() -> None:
    page = REFERENCE.read_text(encoding="utf-8")
    rows = re.findall(r"^   (\S+) +of the radius +(.*)$", page, re.MULTILINE)
    assert [row[0] for row in rows] == ["0.25", "0.5", "1"]
    for cutoff, shown in rows:
        for length, gain in zip((0.25, 0.5, 1, 2, 4), shown.split(), strict=True):
            wave = length * float(cutoff)
            degree = (np.sqrt(1 + (4 * np.pi / wave) ** 2) - 1) / 2
            if gain == "-":
                assert degree < 3
            else:
                assert float(gain) == pytest.approx(sphere_gain(degree, float(cutoff)), abs=6e-4), (
                    cutoff,
                    length,
                )


def test_waves_around_a_torus_have_the_parameters_of_a_sinusoid() -> None:
    # Curvature draws the low-pass in, here less outside than inside: a large radius keeps that
    # difference, of which the form leaves an eighth, below a hundredth of the waves.
    waves, around, along, radius = 64, 768, 400, 20.0  # twelve vertices per wave
    length = 2 * np.pi / waves
    amplitude = 0.02 * length
    phi, theta = np.meshgrid(
        *(2 * np.pi * np.arange(count) / count for count in (along, around)), indexing="ij"
    )
    r = 1 + amplitude * np.cos(waves * theta + 5 * phi)  # at all phases
    rho = radius + r * np.cos(theta)
    V = np.stack([rho * np.cos(phi), rho * np.sin(phi), r * np.sin(theta)], axis=-1).reshape(-1, 3)
    texture = surface_texture(V, quads(grid(along, around, 0, 1)), waviness=3 * length)
    assert texture.vertices_left_out == 0
    assert texture.Sa == pytest.approx(2 / np.pi * amplitude, rel=0.01)
    assert texture.Sq == pytest.approx(amplitude / np.sqrt(2), rel=0.01)
    assert texture.Ssk == pytest.approx(0, abs=0.01)
    assert texture.Sku == pytest.approx(1.5, rel=0.01)
    assert texture.Sz == pytest.approx(2 * amplitude, rel=0.01)
    slope = 2 * np.pi * amplitude / length
    assert texture.Sdr == pytest.approx(slope**2 / 4, rel=0.04)


# Of Sq, at any vertex: form_size is met by cells, which depend on the order and the direction.
CELLS = 0.05


@pytest.mark.parametrize(("form", "error"), [("size", CELLS), ("plane", 2e-3)])
def test_the_order_of_vertices_and_faces_does_not_matter(form: str, error: float) -> None:
    V, F = square("random")
    V = waves(V)
    rng = np.random.default_rng(3)
    order = rng.permutation(len(V))
    G = np.roll(np.argsort(order)[F], 1, axis=1)[rng.permutation(len(F))]
    one = surface_texture(V, F, waviness=3.0, noise=0.4, form=form)
    other = surface_texture(V[order], G, waviness=3.0, noise=0.4, form=form)
    np.testing.assert_allclose(other.height, one.height[order], atol=error * one.Sq)
    assert other.vertices_evaluated == one.vertices_evaluated
    for name in ("Sa", "Sq", "Sku", "Sz", "Sdr"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), rel=min(error, 0.01)), name


@pytest.mark.parametrize(("form", "error"), [("size", CELLS), ("cylinder", 1e-4)])
def test_a_turned_scaled_and_moved_mesh_has_the_same_texture(form: str, error: float) -> None:
    V, F = cylinder(3.0, 16, 0.002)
    turn = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0]
    turn *= np.linalg.det(turn)
    one = surface_texture(V, F, waviness=1.2, form=form)
    other = surface_texture(40 * V @ turn + [700, -200, 90], F, waviness=48, form=form)
    np.testing.assert_allclose(other.height, 40 * one.height, atol=error * other.Sq)
    assert other.Sdr == pytest.approx(one.Sdr, rel=min(error, 0.005))


def mirrored_map(cells: int) -> Array:
    """Heights without symmetry, and mirrored: whatever is said of the rim, their means agree."""
    x = np.arange(cells + 1) / cells
    x, y = np.meshgrid(x, x, indexing="ij")
    z = np.exp(3 * np.sin(7 * x + 2 * y)) + 2 * np.cos(11 * x * y + y)
    return np.pad(2e-3 * z, ((0, cells), (0, cells)), mode="reflect")


def height_map(z: Array, step: float) -> tuple[Array, NDArray[Any]]:
    n, m = z.shape
    x, y = np.meshgrid(step * np.arange(n), step * np.arange(m), indexing="ij")
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()]), quads(grid(n, m))


def test_a_height_map_has_the_moments_of_its_pixels() -> None:
    z = mirrored_map(100)
    texture = surface_texture(*height_map(z, 0.01), waviness="100%", form="plane", crease_angle=180)
    pixels = z[:-1, :-1] - z[:-1, :-1].mean()
    Sq = np.sqrt((pixels**2).mean())
    assert texture.Sa == pytest.approx(np.abs(pixels).mean(), rel=1e-6)
    assert texture.Sq == pytest.approx(Sq, rel=1e-6)
    assert texture.Ssk == pytest.approx((pixels**3).mean() / Sq**3, rel=1e-6)
    assert texture.Sku == pytest.approx((pixels**4).mean() / Sq**4, rel=1e-6)
    assert texture.Sz == pytest.approx(np.ptp(z), rel=1e-6)


def moments(squares: float, cubes: float) -> tuple[float, float]:
    return squares**0.5, cubes / squares**1.5


def test_skewness_converges_to_the_closed_form_in_the_second_order_unlike_means_of_pixels() -> None:
    # x^4 less its least-squares line. Pixels at the rim count whole, of which half is outside.
    shape = np.polynomial.Polynomial([0.2, -0.8, 0, 0, 1])
    exact = moments(*((shape**power).integ()(1) for power in (2, 3)))

    def errors(cells: int) -> tuple[Array, Array]:
        x = np.arange(cells + 1) / cells
        z = np.broadcast_to(1e-3 * shape(x)[:, None], (cells + 1, cells + 1))
        mesh = height_map(z, 1 / cells)
        ours = surface_texture(*mesh, waviness="100%", form="plane", crease_angle=180)
        pixels = x**4 - np.polyval(np.polyfit(x, x**4, 1), x)
        by_pixels = moments(*((pixels**power).mean() for power in (2, 3)))
        return np.abs(np.array([1e3 * ours.Sq, ours.Ssk]) / exact - 1), np.abs(
            np.array(by_pixels) / exact - 1
        )

    (ours, pixels), (finer, finer_pixels) = errors(40), errors(160)
    assert (finer < ours / 12).all()  # second order
    assert (finer_pixels > pixels / 6).all()  # first order


def test_parts_thinner_than_the_cutoff_are_left_out_and_named() -> None:
    ball = pyvista.Icosphere(radius=1, nsub=5)
    V, F = np.asarray(ball.points, dtype=np.float64), ball.regular_faces
    bead = 0.05 * V + [3, 0, 0]  # its circumference is .31
    both = np.vstack([V, bead]), np.vstack([F, F + len(V)])
    texture = surface_texture(*both, waviness=0.5, crease_angle=180)
    assert texture.vertices_too_thin == len(V)
    assert texture.vertices_evaluated == len(V)
    assert not texture.height[len(V) :].any()
    assert any(f"the first is vertex {len(V)}." in warning for warning in texture.warnings)
    fine = surface_texture(*both, waviness=0.1, crease_angle=180)
    assert fine.vertices_too_thin == 0
    assert not any("thinner" in warning for warning in fine.warnings)
    with pytest.raises(OptionError, match="thinner than this"):
        surface_texture(np.vstack([bead, bead + 2]), both[1], waviness=0.5, crease_angle=180)


def test_what_is_near_the_middle_of_a_long_crease_is_left_out() -> None:
    """A ridge whose crease is one row of long edges, as CAD models have them."""
    x, y = np.meshgrid(np.array([-4.0, *np.linspace(-2, 2, 41), 4]), np.linspace(0, 12, 4))
    y[:, 1:-1] += 0.5 * (np.arange(41) % 2)  # no vertex next to the crease is level with its ends
    z = 4 - np.abs(x)
    V = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    texture = surface_texture(V, quads(grid(*x.shape).T), waviness=0.6, form="none")
    near = np.abs(x.ravel()) * np.sqrt(2) < 0.6  # the distance to the ridge along the surface
    assert near.sum() > 20
    assert not texture.height[near].any()


@pytest.mark.parametrize("sides", [3, 4, 5, 6])
def test_flanks_of_a_prism_are_not_rough_by_its_edges(sides: int) -> None:
    prism = pyvista.Cylinder(radius=1, height=2, resolution=sides, capping=True).triangulate()
    prism = prism.clean().subdivide(5, "linear").clean()
    V, F = np.asarray(prism.points, dtype=np.float64), prism.regular_faces
    V = V + 1e-4 * np.random.default_rng(1).standard_normal(V.shape)
    texture = surface_texture(V, F, waviness=0.2)
    assert texture.vertices_left_out < 0.9 * len(V)
    kept = surface_texture(V, F, waviness=0.2, crease_angle=180)
    # A low-pass one cutoff away from an edge of 120 degrees is a hundredth of the cutoff off.
    assert texture.Sz < 0.015 * 0.2
    assert texture.Sz < 0.05 * kept.Sz


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
    assert any("of the area has no texture" in warning for warning in whole.warnings)
    assert not any("has no texture" in warning for warning in texture.warnings)


def test_waves_sampled_at_their_zeros_are_texture() -> None:
    V, F = square("fine")
    V[:, 2] = 0.004 * np.sin(np.pi * np.round(V[:, 0] / V[:, 0].max() * 279) / 5)
    texture = surface_texture(V, F, waviness=3.0, form="plane")
    assert (np.abs(texture.height) < 1e-6).sum() > 0.19 * texture.vertices_evaluated
    assert not any("has no texture" in warning for warning in texture.warnings)


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
    assert report.keys() | {"warnings", "warning_codes"} == texture.report.keys()
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


def test_roughness_is_no_crease_and_a_surface_that_is_mostly_left_out_is_told() -> None:
    V, F = square("square")
    V = V + [0, 0, 0.012] * np.random.default_rng(4).normal(size=(len(V), 1))
    texture = surface_texture(V, F, waviness=0.3)
    assert not texture.warnings
    assert texture.vertices_evaluated > 0.8 * len(V)
    texture = surface_texture(V, F, waviness=3.0)
    assert texture.vertices_left_out > texture.vertices_evaluated
    assert any("within a cutoff of boundaries" in warning for warning in texture.warnings)


def test_cutoffs_have_the_names_of_the_standard() -> None:
    V, F = square("square")
    ours = surface_texture(waves(V), F, waviness=3.0, noise=0.5)
    theirs = surface_texture(waves(V), F, nesting_index_l=3.0, nesting_index_s=0.5)
    assert ours.report == theirs.report
    with pytest.raises(OptionError, match="nesting_index_l = waviness: give one of the two"):
        surface_texture(waves(V), F, nesting_index_l=3.0, waviness=3.0)


def test_the_material_ratio_is_the_share_of_higher_heights() -> None:
    V, F = square("fine")
    texture = surface_texture(waves(V), F, waviness="100%", form="plane")
    for c in (-0.006, -0.001, 0.0, 0.003):
        share = (texture.height[texture.height != 0] >= c).mean()
        assert texture.material_ratio(c) == pytest.approx(share, abs=0.01)
    assert (texture.material_ratio([-1, 1]) == [1, 0]).all()
    assert np.isnan(texture.material_ratio(np.nan))
    # The core of ISO 13565-2, from the quantiles of the closed form.
    x = (np.arange(1200) + 0.5) / 1200
    z = np.add.outer(np.cos(2 * np.pi * x), np.cos(2 * np.pi * x)).ravel() * 0.004
    curve = np.quantile(z, 1 - np.linspace(0, 1, 1001))
    first = int(np.argmin(curve[:-400] - curve[400:]))
    slope, top = np.polyfit(
        np.linspace(0, 1, 1001)[first : first + 401], curve[first : first + 401], 1
    )
    assert texture.Sk == pytest.approx(-slope, rel=0.02)
    assert texture.Smr1 == pytest.approx((z > top).mean(), abs=0.01)
    assert texture.Smr2 == pytest.approx((z > top + slope).mean(), abs=0.01)
    assert texture.Spk == pytest.approx(2 * (z - top)[z > top].mean(), rel=0.03)


def test_grains_and_scratches_are_measured() -> None:
    V, F = square("fine")
    z = np.zeros(len(V))
    for x, y in ((4.0, 4.0), (6.0, 7.5), (8.0, 5.0)):
        r = np.hypot(V[:, 0] - x, V[:, 1] - y)
        z += np.where(r < 0.15, np.sqrt(np.maximum(0, 0.15**2 - r**2)), 0)
    z -= np.where(np.abs(V[:, 0] - V[:, 1]) < 0.05, 0.05, 0)
    rough = np.column_stack([V[:, 0], V[:, 1], z])
    plane = surface_texture(rough, F, waviness=2.0, form="plane")
    free = surface_texture(rough, F, waviness=2.0)
    kept = surface_texture(rough, F, waviness=2.0, crease_angle=180)
    assert free.vertices_evaluated == kept.vertices_evaluated
    assert free.Sq == pytest.approx(plane.Sq, rel=0.03)
    assert plane.Sp == pytest.approx(0.15, rel=0.1)
