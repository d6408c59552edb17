"""Spectral Equalizer: one gain for every octave of sizes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers import (
    assert_same,
    decorated,
    diagonal,
    filter_arrays,
    largest_distance,
    length,
    loaded,
    lower_part,
    mesh_set_of,
    percent,
    refusal,
    snapshot,
)
from meshlab_spectral.plugin.library import last_summary, last_warnings
from numpy.typing import NDArray
from shapes import sphere
from shared_types import Decimated

EQUALIZER = "apply_coord_spectral_equalizer"
TIMES = (32, 16, 8, 4, 2, 1)
SLIDERS = [f"gain_{times}x" for times in TIMES]

Arrays = tuple[NDArray[np.float64], NDArray[Any]]


@pytest.fixture(scope="module")
def cow(decimated: Decimated) -> Arrays:
    V, F = decimated("cow.obj", 2400)
    return V, F


def equalized(V: NDArray[Any], F: NDArray[Any], **parameters: Any) -> NDArray[np.float64]:
    mesh_set = mesh_set_of(V, F)
    mesh_set.apply_filter(EQUALIZER, **parameters)
    vertices: NDArray[np.float64] = mesh_set.current_mesh().vertex_matrix().copy()
    return vertices


def mean_edge(V: NDArray[Any], F: NDArray[Any]) -> float:
    return float(np.linalg.norm(V[F] - V[np.roll(F, 1, axis=1)], axis=2).mean())


def default_smallest_size(V: NDArray[Any], F: NDArray[Any]) -> float:
    return min(3 * mean_edge(V, F), 0.025 * diagonal(V))


def test_the_sliders_stand_at_one_and_the_smallest_size_at_three_edges(
    samples: Path, cow: Arrays
) -> None:
    fine = loaded(samples / "bunny.obj")
    for mesh_set in (fine, mesh_set_of(*cow)):
        values = mesh_set.filter_parameter_values(EQUALIZER)
        names = [*SLIDERS, "smallest_size", "selected", "boundary", "accurate"]
        assert list(values) == [*names, "color_by_displacement", "keep_original"]
        assert all(values[name] == 1.0 for name in SLIDERS)
        mesh = mesh_set.current_mesh()
        size = default_smallest_size(mesh.vertex_matrix(), mesh.face_matrix())
        assert values["smallest_size"] == pytest.approx(size, rel=1e-6)


def test_gains_of_one_change_no_bit_and_say_so(cow: Arrays) -> None:
    mesh_set = decorated(*cow)
    mesh = mesh_set.current_mesh()
    before = snapshot(mesh)
    report = mesh_set.apply_filter(EQUALIZER, selected=False)
    assert_same(before, snapshot(mesh))
    assert last_summary() == "all gains are 1; nothing changed"
    assert last_warnings() == []
    assert report["max_displacement"] == report["rms_displacement"] == 0.0
    assert report["area_after"] == report["area_before"]
    assert report["solves"] == report["products"] == 0


@pytest.mark.parametrize("gain", [0.0, 0.5, 2.0])
@pytest.mark.parametrize("slider", SLIDERS)
def test_a_slider_is_a_custom_transfer_function_with_its_points(
    slider: str, gain: float, cow: Arrays
) -> None:
    V, F = cow
    smallest = 0.02 * diagonal(V)
    points = [f"{64 * smallest:.17g}:1"]
    for times, name in zip(TIMES, SLIDERS, strict=True):
        points.append(f"{times * smallest:.17g}:{gain if name == slider else 1}")
    expected, _ = filter_arrays(V, F, filter_type="custom", transfer_function=", ".join(points))
    chosen = {slider: gain, "smallest_size": length(smallest)}
    found = equalized(V, F, accurate=True, **chosen)
    assert largest_distance(expected, V) > 0.0
    assert largest_distance(found, expected) < 1e-6 * diagonal(V)
    quick = equalized(V, F, **chosen)
    # Where a band vanishes, parts of the cow collapse, in many steps.
    share = 0.4 if gain == 0.0 else 0.03
    if gain == 0.0 and slider == "gain_32x":
        share = 0.6  # sizes of two thirds of the cow
    assert np.linalg.norm(quick - found) < share * np.linalg.norm(found - V)


@pytest.mark.parametrize("gain", [0.0, 0.5, 2.0])
def test_details_finer_than_the_smallest_size_follow_the_last_slider(gain: float) -> None:
    V, F = sphere(4)
    noise = 0.002 * np.random.default_rng(3).standard_normal(len(V))
    size = length(5 * mean_edge(V, F))  # most of the noise is finer
    found = equalized((1 + noise)[:, None] * V, F, gain_1x=gain, smallest_size=size)
    assert np.std(np.linalg.norm(found, axis=1)) / np.std(noise) == pytest.approx(gain, abs=0.25)


def test_the_overall_shape_stays(cow: Arrays) -> None:
    V, F = cow
    for gain in (0.0, 4.0):
        changed = equalized(V, F, gain_2x=gain, gain_1x=gain, smallest_size=percent(2))
        np.testing.assert_allclose(np.ptp(changed, axis=0), np.ptp(V, axis=0), rtol=0.15)


@pytest.mark.parametrize("slider", SLIDERS)
def test_a_gain_that_is_not_a_number_is_refused_by_name(slider: str, cow: Arrays) -> None:
    mesh_set = mesh_set_of(*cow)
    before = snapshot(mesh_set.current_mesh())
    assert f"{slider} = nan" in refusal(mesh_set, EQUALIZER, **{slider: float("nan")})
    assert_same(before, snapshot(mesh_set.current_mesh()))


@pytest.mark.parametrize(
    ("beyond", "end"), [(-1.0, 0.0), (float("-inf"), 0.0), (9.0, 4.0), (float("inf"), 4.0)]
)
def test_pymeshlab_clamps_a_gain_beyond_the_slider(beyond: float, end: float, cow: Arrays) -> None:
    expected = equalized(*cow, gain_4x=end)
    np.testing.assert_array_equal(equalized(*cow, gain_4x=beyond), expected)


@pytest.mark.parametrize("size", [0.0, float("nan")])
def test_an_invalid_smallest_size_is_refused_by_name(size: float, cow: Arrays) -> None:
    mesh_set = mesh_set_of(*cow)
    assert "smallest_size" in refusal(mesh_set, EQUALIZER, gain_2x=2.0, smallest_size=length(size))


def test_a_quick_run_reports_its_error_and_an_accurate_one_keeps_the_tolerance(cow: Arrays) -> None:
    V, F = cow
    for accurate in (False, True):
        mesh_set = mesh_set_of(V, F)
        report = mesh_set.apply_filter(EQUALIZER, gain_8x=0.0, accurate=accurate)
        assert last_warnings() == []
        assert report["tolerance_reached"] == accurate
        assert (report["steps"] <= 2) == (not accurate)
        assert (report["step_error"] <= 0.0005 * diagonal(V)) == accurate


def test_only_the_selection_moves_on_request(cow: Arrays) -> None:
    V, F = cow
    parameters: dict[str, Any] = {"gain_1x": 0.0, "smallest_size": percent(0.8)}
    mesh_set = mesh_set_of(V, F)
    mesh = mesh_set.current_mesh()
    mesh_set.compute_selection_by_condition_per_vertex(
        condselect=f"x > {np.quantile(V[:, 0], 0.8)}"
    )
    selected = mesh.vertex_selection_array().copy()
    mesh_set.apply_filter(EQUALIZER, selected=True, **parameters)
    moved = np.any(mesh.vertex_matrix() != V, axis=1)
    assert np.all(moved[selected])
    assert selected.mean() < moved.mean() < 0.9
    assert any("only the selection" in warning for warning in last_warnings())


def test_a_fixed_boundary_stays(cow: Arrays) -> None:
    V, F = lower_part(*cow)
    edges, counts = np.unique(
        np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0, return_counts=True
    )
    rim = np.unique(edges[counts == 1])
    fixed = equalized(V, F, gain_1x=0.0, gain_2x=2.0, boundary="fixed")
    np.testing.assert_array_equal(fixed[rim], V[rim])
    assert np.any(equalized(V, F, gain_1x=0.0, gain_2x=2.0)[rim] != V[rim])
