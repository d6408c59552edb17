"""`compare`: distances and signs against closed forms and brute force."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import plyfile
import pytest
import trimesh
import trimesh.proximity
from meshlab_spectral import MeshFileError, compare
from numpy.typing import NDArray
from shapes import grid, quads
from shared_types import Decimated

pytest.importorskip("pyvista", reason="the extra render is not installed")

Array = NDArray[np.float64]


def square(cells: int, size: float = 1.0) -> tuple[Array, NDArray[np.int64]]:
    """A square in the plane z = 0, with normals to +z."""
    x, y = np.meshgrid(*[np.linspace(0, size, cells + 1)] * 2, indexing="ij")
    V = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    return V, quads(grid(cells + 1, cells + 1))


def shifted(V: Array, *by: float) -> Array:
    return V + np.array(by)


def sphere(radius: float, resolution: int) -> tuple[Array, NDArray[np.int64]]:
    import pyvista

    ball = pyvista.Icosphere(radius=1, nsub=resolution)
    V = np.asarray(ball.points, dtype=np.float64)
    return radius * V / np.linalg.norm(V, axis=1, keepdims=True), ball.regular_faces


def box(*lengths: float) -> tuple[Array, NDArray[np.int64]]:
    import pyvista

    cube = pyvista.Cube(x_length=lengths[0], y_length=lengths[1], z_length=lengths[2])
    cube = cube.triangulate().clean()
    return np.asarray(cube.points, dtype=np.float64), cube.regular_faces


def nearest(p: Array, V: Array, F: NDArray[Any]) -> float:
    """Distance of a point to the nearest of all triangles, by the minimum over each of them."""
    a, b, c = (V[F[:, corner]] for corner in range(3))
    best = np.inf
    for s, t in ((a, b), (b, c), (c, a)):
        d = t - s
        along = np.clip(((p - s) * d).sum(1) / (d * d).sum(1), 0, 1)
        best = min(best, np.linalg.norm(p - s - along[:, None] * d, axis=1).min())
    n = np.cross(b - a, c - a)
    height = ((p - a) * n).sum(1) / (n * n).sum(1)
    q = p - height[:, None] * n
    inside = np.ones(len(F), dtype=bool)
    for s, t in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(t - s, q - s) * n).sum(1) >= 0
    plane = np.abs(height) * np.linalg.norm(n, axis=1)
    return min(best, plane[inside].min(initial=np.inf))


def test_volumes_of_parts_far_apart_are_the_sum_of_theirs() -> None:
    V, F = sphere(1.0, 3)
    two = np.vstack([V, V + 1e6]), np.vstack([F, F + len(V)])
    one, both = (compare(mesh, mesh).volumes for mesh in ((V, F), two))
    assert one is not None
    assert both == pytest.approx((2 * one[0], 2 * one[0]), rel=1e-6)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_concentric_spheres_of_other_faces_are_their_gap_apart(scale: float) -> None:
    (V, F), (W, G) = sphere(scale, 4), sphere(1.1 * scale, 3)
    result = compare((V, F), (W, G))
    assert not result.same_faces
    # A chord of an icosphere lies below the sphere by a quarter of a squared edge at most.
    for name in ("a_to_b", "b_to_a"):
        one = result.deviations[name]
        np.testing.assert_allclose(one.values, 0.1 * scale, atol=6e-3 * scale)
        assert one.mean == pytest.approx(0.1 * scale, abs=5e-3 * scale)
        assert one.rms == pytest.approx(one.mean, rel=1e-2)
    assert result.areas[1] / result.areas[0] == pytest.approx(1.21, rel=5e-3)
    assert result.volumes is not None
    assert result.volumes[1] / result.volumes[0] == pytest.approx(1.331, rel=7e-3)
    back = compare((W, G), (V, F))
    np.testing.assert_array_equal(
        back.deviations["a_to_b"].values, -result.deviations["b_to_a"].values
    )


def test_closed_surfaces_alone_have_volumes() -> None:
    V, F = sphere(1.0, 3)
    far = V + 1e6
    assert compare((far, F), (far, F)).volumes == pytest.approx((4.15, 4.15), rel=0.02)
    is_cap = (abs(V[:, 2]) > 0.9)[F].any(axis=1)  # a tube, whose area vectors cancel
    assert compare((V, F[~is_cap]), (V, F[~is_cap])).volumes is None


def test_shifted_planes_are_the_shift_apart_on_its_side() -> None:
    for shift in (0.25, -0.25):
        (V, F), (W, G) = square(8), square(5)
        result = compare((V, F), (shifted(W, 0, 0, shift), G))
        for one in result.deviations.values():
            np.testing.assert_allclose(one.values, shift, atol=1e-12)
        assert result.volumes is None


@pytest.mark.parametrize("growth", [0.004, -0.004])
def test_both_sides_of_a_thin_plate_have_the_sign_of_its_growth(growth: float) -> None:
    (V, F), (W, G) = box(10, 10, 0.02), box(10, 10, 0.02 + 2 * growth)
    import pyvista

    fine = pyvista.PolyData.from_regular_faces(W, G).subdivide(3)
    W, G = np.asarray(fine.points, dtype=np.float64), fine.regular_faces
    result = compare((V, F), (W, G))
    inner = np.abs(W[:, :2]).max(axis=1) < 4.9
    assert inner.sum() > 50
    np.testing.assert_allclose(result.deviations["b_to_a"].values[inner], growth, atol=1e-6)
    assert np.sign(result.deviations["b_to_a"].mean) == np.sign(growth)


def test_distances_are_those_to_the_nearest_of_all_triangles(decimated: Decimated) -> None:
    (V, F), (W, G) = decimated("bunny.obj", 1200), decimated("bunny.obj", 500)
    result = compare((V, F), (W, G))
    diagonal = np.linalg.norm(np.ptp(V, axis=0))
    for name, X, other in (("a_to_b", V, (W, G)), ("b_to_a", W, (V, F))):
        exact = np.array([nearest(p, *other) for p in X])
        measured = np.abs(result.deviations[name].values)
        np.testing.assert_allclose(measured, exact, atol=1e-6 * diagonal)


def torus(resolution: int) -> tuple[Array, NDArray[Any]]:
    import pyvista

    ring = pyvista.ParametricTorus(
        ringradius=1, crosssectionradius=0.3, u_res=2 * resolution, v_res=resolution
    )
    ring = ring.triangulate().clean(tolerance=1e-6)
    return np.asarray(ring.points, dtype=np.float64), ring.regular_faces


def plate(thickness: float) -> tuple[Array, NDArray[Any]]:
    """A bent plate, closed, hardly thicker than what is measured."""
    import pyvista

    fine = pyvista.PolyData.from_regular_faces(*box(2, 1, thickness)).subdivide(3, "linear")
    V = np.asarray(fine.points, dtype=np.float64)
    return V + np.outer(0.2 * V[:, 0] ** 2, [0, 0, 1]), fine.regular_faces


def scaled(mesh: tuple[Array, NDArray[Any]], *by: float) -> tuple[Array, NDArray[Any]]:
    return mesh[0] * by, mesh[1]


def outward(mesh: tuple[Array, NDArray[Any]]) -> tuple[Array, NDArray[Any]]:
    V, F = mesh
    return (V, F) if np.linalg.det(V[F]).sum() > 0 else (V, F[:, ::-1])


PAIRS: dict[str, Callable[[], tuple[Any, Any]]] = {
    "spheres": lambda: (sphere(1, 3), sphere(1.05, 2)),
    "sphere and ellipsoid": lambda: (sphere(1, 3), scaled(sphere(1, 2), 1.3, 0.9, 0.7)),
    "waves": lambda: (sphere(1, 3), waved(sphere(1, 2))),
    "tori": lambda: (torus(24), scaled(torus(16), 1.02)),
    "torus and bent torus": lambda: (torus(24), waved(torus(20))),
    "sphere and torus": lambda: (sphere(1, 3), torus(20)),
    "box and sphere": lambda: (box(1, 1, 1), sphere(0.6, 3)),
    "thicker plate": lambda: (plate(0.02), plate(0.026)),
    "thinner plate": lambda: (plate(0.02), plate(0.014)),
    "moved plate": lambda: (plate(0.02), (shifted(plate(0.03)[0], 0, 0, 0.013), plate(0.03)[1])),
}  # fmt: skip


def waved(mesh: tuple[Array, NDArray[Any]]) -> tuple[Array, NDArray[Any]]:
    V, F = mesh
    return V * (1 + 0.03 * np.sin(7 * V[:, :1] + 4 * V[:, 1:2])), F


@pytest.mark.parametrize("name", PAIRS)
def test_signed_distances_are_those_of_trimesh(name: str) -> None:
    a, b = (outward(mesh) for mesh in PAIRS[name]())
    # Facets of both kinds of plates differ.
    b = b[0], np.roll(b[1], 1, axis=0)
    result = compare(a, b)
    assert not result.same_faces
    for key, (V, _), other in (("a_to_b", a, b), ("b_to_a", b, a)):
        solid = trimesh.Trimesh(*other, process=False)
        _, exact, _ = trimesh.proximity.closest_point_naive(solid, V)
        values = result.deviations[key].values
        np.testing.assert_allclose(np.abs(values), exact, atol=1e-7)
        # Inside by the winding number: the sum of the solid angles, no nearest point is asked.
        inside = winding_number(V, *other) > 0.5
        positive = inside if key == "a_to_b" else ~inside
        clear = exact > 1e-6
        assert clear.any()
        np.testing.assert_array_equal(values[clear] > 0, positive[clear])


def winding_number(points: Array, V: Array, F: NDArray[Any]) -> Array:
    """How often a closed surface winds around each point (van Oosterom and Strackee 1983)."""
    total = np.zeros(len(points))
    for face in F:
        a, b, c = (V[corner] - points for corner in face)
        A, B, C = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        volume = (a * np.cross(b, c)).sum(1)
        cosine = A * B * C + (a * b).sum(1) * C + (b * c).sum(1) * A + (c * a).sum(1) * B
        total += np.arctan2(volume, cosine)
    return total / (2 * np.pi)


def test_the_sign_at_every_edge_and_corner_is_that_of_the_side() -> None:
    V, F = box(1, 1, 1)
    rng = np.random.default_rng(7)
    P = rng.uniform(-1, 1, (400, 3))
    points = P, np.column_stack([np.arange(398), np.arange(1, 399), np.arange(2, 400)])
    outside = np.abs(P).max(axis=1) > 0.5
    values = compare((V, F), points).deviations["b_to_a"].values
    np.testing.assert_array_equal(values > 0, outside)


def test_with_the_same_faces_a_displacement_is_split_along_normal_and_surface() -> None:
    V, F = square(6)
    result = compare((V, F), (shifted(V, 0.3, 0, -0.4), F))
    assert result.same_faces
    parts = {name: one.values for name, one in result.deviations.items()}
    np.testing.assert_allclose(parts["displacement"], 0.5)
    np.testing.assert_allclose(parts["normal"], -0.4)
    np.testing.assert_allclose(parts["tangential"], 0.3)


def test_statistics_are_those_over_the_surface_and_name_the_largest() -> None:
    V, F = square(40)
    W = V + np.outer(V[:, 0] ** 2, [0, 0, 1])
    one = compare((V, F), (W, F)).deviations["normal"]
    assert one.mean == pytest.approx(1 / 3, rel=2e-3)
    assert one.rms == pytest.approx(np.sqrt(1 / 5), rel=2e-3)
    for share, value in one.percentiles.items():
        assert value == pytest.approx((share / 100) ** 2, abs=0.05)
    assert one.largest == 1
    assert one.position[0] == 1
    assert tuple(V[one.vertex]) == one.position


def test_vertices_without_faces_do_not_count() -> None:
    V, F = square(4)
    lost = np.vstack([V, [[0.0, 0, 99]]])
    moved = shifted(V, 0, 0, 1)
    for other in (np.vstack([moved, [[0.0, 0, 0]]]), moved):
        result = compare((lost, F), (other, F))
        for name in result.deviations.keys() - {"tangential"}:
            assert result.deviations[name].largest == pytest.approx(1)
            assert result.deviations[name].mean == pytest.approx(1)


def test_files_are_compared_as_their_arrays(tmp_path: Path) -> None:
    V, F = square(3)
    for name, height in (("a.ply", 0.0), ("b.ply", 0.5)):
        rows = np.array([tuple(v) for v in shifted(V, 0, 0, height)], [(c, "f8") for c in "xyz"])
        faces = np.array([(face,) for face in F], [("vertex_indices", "i4", (3,))])
        elements = [plyfile.PlyElement.describe(rows, "vertex"),
                    plyfile.PlyElement.describe(faces, "face")]  # fmt: skip
        plyfile.PlyData(elements).write(tmp_path / name)
    result = compare(tmp_path / "a.ply", str(tmp_path / "b.ply"))
    assert result.same_faces
    np.testing.assert_array_equal(result.deviations["normal"].values, np.full(16, 0.5))


def test_what_cannot_be_compared_is_named(tmp_path: Path) -> None:
    V, F = square(2)
    hole = V.copy()
    hole[3] = np.nan
    with pytest.raises(ValueError, match="b has coordinates"):
        compare((V, F), (hole, F))
    with pytest.raises(ValueError, match="a has no face"):
        compare((0 * V, F), (V, F))
    with pytest.raises(MeshFileError, match="missing"):
        compare(tmp_path / "missing.ply", (V, F))


def strip(low: float, high: float, cells: int) -> tuple[NDArray[Any], NDArray[Any]]:
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(low, high, cells + 1), np.arange(11) / 10))
    return np.column_stack([x, y, 0 * x]), quads(grid(11, cells + 1).T)


def test_what_lies_beyond_a_rim_is_counted_apart() -> None:
    """Two scans that overlap in half, .01 apart."""
    (V, F), (W, G) = strip(0, 1, 10), strip(0.5, 1.5, 12)
    W[:, 2] = 0.01
    change = compare((V, F), (W, G))
    for name, one in change.deviations.items():
        assert abs(one.mean) == pytest.approx(0.01, rel=0.2), name
        assert abs(one.largest) < 0.012
        assert change.beyond[name] == pytest.approx(0.5, abs=0.1)
    assert [w.split(" lies")[0].split("% ")[1] for w in change.warnings] == [
        f"of the surface of {name}" for name in "ab"
    ]
    assert change.report["beyond"] == change.beyond
    farther = compare((V, F), (W, G), max_distance=0.001)
    assert set(farther.beyond.values()) == {1.0}
    whole = compare((V, F), (V + np.array([0, 0, 0.01]), F[::-1]))
    assert set(whole.beyond.values()) == {0.0}


@pytest.mark.parametrize("factor", [10.0, 25.4, 100.0, 1000.0])
@pytest.mark.parametrize("same", [False, True])
def test_other_units_are_named(same: bool, factor: float) -> None:
    V, F = strip(0, 1, 10)
    change = compare((V, F), (factor * V, F if same else F[::-1]))
    assert change.warnings[0] == f"b is {factor:g} times as large as a: are the units equal?"
    assert not compare((V, F), (1.5 * V, F)).warnings
