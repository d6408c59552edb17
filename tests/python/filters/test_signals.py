"""Vertex quality and colours are filtered as an independent implementation with SciPy does."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
import pyvista
import spectral_reference as reference
from helpers import FILTER, assert_same, length, lower_part, mesh_set_of, percent, refusal, snapshot
from meshlab_spectral import FilterError, FilterOptions, OptionError, filter_colors, filter_scalars
from numpy.typing import NDArray
from shared_types import Decimated, Record
from transfer_functions import RESPONSES, TYPES, gain_of

QUALITY = "apply_scalar_spectral_filter_per_vertex"
COLOR = "apply_color_spectral_filter_per_vertex"
TARGETS = {QUALITY: "vertex_scalar_array", COLOR: "vertex_color_matrix"}
AGREEMENT = 1e-6  # of the range of the field

Array = NDArray[np.float64]

TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])


def noisy_field(V: Array) -> Array:
    """A smooth field with white noise, far from zero."""
    x, y, z = ((V - V.mean(axis=0)) / np.ptp(V)).T
    noise = np.random.default_rng(3).standard_normal(len(V))
    return 100 + np.sin(9 * x) + np.cos(7 * y) * z + 0.2 * noise


def colours(V: Array) -> NDArray[np.uint8]:
    """Colours of all levels, alpha included."""
    noise = np.random.default_rng(4).integers(-60, 60, (len(V), 4))
    waves = 128 + 100 * np.sin(np.outer(V[:, 0] / np.ptp(V), [5, 6, 7, 8]))
    return np.clip(waves + noise, 0, 255).astype(np.uint8)


def coloured(V: Array, F: NDArray[Any], levels: NDArray[np.uint8]) -> pymeshlab.MeshSet:
    mesh_set = mesh_set_of(V, F, v_color_matrix=levels / 255)
    assert np.array_equal(levels_of(mesh_set), levels)
    return mesh_set


def levels_of(mesh_set: pymeshlab.MeshSet) -> NDArray[np.int64]:
    levels = 255 * mesh_set.current_mesh().vertex_color_matrix()
    return np.rint(levels).astype(np.int64)


def expected_signals(
    V: Array, F: NDArray[Any], Q: Array, options: dict[str, Any], report: dict[str, Any]
) -> Array:
    """F(sqrt(A)) Q with all eigenvectors."""
    W, d = reference.matrices(V, F, options["laplacian"])
    spectrum = reference.spectra(W, d, reference.components(len(V), F))
    return reference.apply_gain(Q, spectrum, gain_of(options, report))


@pytest.mark.parametrize("kind", TYPES)
def test_filtered_quality_agrees_with_scipy(
    kind: str, sample_name: str, decimated: Decimated, record_property: Record
) -> None:
    V, F = decimated(sample_name)
    Q = noisy_field(V)
    for name, response in RESPONSES.items():
        options = {"laplacian": "cotangent", **TYPES[kind], **response}
        Y, report = filter_scalars(V, F, Q, feature_size="15%", **options)
        expected = expected_signals(V, F, Q[:, None], options, report)[:, 0]
        error = np.abs(Y - expected).max() / np.ptp(Q)
        record_property(f"error, {name}", float(error))
        assert error <= AGREEMENT, name
        assert report["warnings"] == []
        change, d = expected - Q, reference.lumped_areas(V, F)
        near = {"abs": AGREEMENT * np.ptp(Q)}
        assert report["max_change"] == pytest.approx(np.abs(change).max(), **near)
        assert report["rms_change"] == pytest.approx(np.sqrt(d @ change**2 / d.sum()), **near)


def test_the_default_laplacian_agrees_with_robust_laplacian(
    sample_name: str, decimated: Decimated
) -> None:
    V, F = decimated(sample_name)
    Q = noisy_field(V)
    Y, report = filter_scalars(V, F, Q, feature_size="15%")
    expected = expected_signals(V, F, Q[:, None], {"laplacian": "intrinsic delaunay"}, report)
    np.testing.assert_allclose(Y, expected[:, 0], rtol=0, atol=AGREEMENT * np.ptp(Q))


def test_colours_in_arrays_are_those_of_the_filter(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    C = colours(V)
    mesh_set = coloured(V, F, C)
    mesh_set.apply_filter(COLOR, feature_size=percent(15))
    found, report = filter_colors(V, F, C, feature_size="15%")
    np.testing.assert_array_equal(found, levels_of(mesh_set))
    np.testing.assert_array_equal(found[:, 3], C[:, 3])
    assert report["max_change"] > 10
    without_alpha, _ = filter_colors(V, F, C[:, :3], feature_size="15%")
    np.testing.assert_array_equal(without_alpha, found[:, :3])
    as_floats, _ = filter_colors(V, F, C / 255, feature_size="15%")
    np.testing.assert_allclose(as_floats, found / 255, atol=1e-7)
    with pytest.raises(ValueError, match="from 0 to 255"):
        filter_colors(V, F, C[:, :2])
    with pytest.raises(ValueError, match="from 0 to 255"):
        filter_colors(V, F, C.astype(float))


def test_colours_that_nothing_filters_stay(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    rng = np.random.default_rng(4)
    floats = rng.uniform(size=(len(V), 4))
    for C in (floats, floats.astype(np.float32)):
        same, _ = filter_colors(V, F, C, gain=lambda w: np.ones_like(w))
        change = same[:, :3] - C[:, :3]
        assert np.abs(change).max() < 0.5 / 255 + 1e-6
        assert abs(change.mean()) < 0.02 / 255 * 3  # rounded, not floored
        np.testing.assert_array_equal(same[:, 3], C[:, 3])
    levels = rng.integers(0, 256, (len(V), 3))
    for kind in (np.uint8, np.int64):
        same, _ = filter_colors(V, F, levels.astype(kind), gain=lambda w: np.ones_like(w))
        np.testing.assert_array_equal(same, levels)


@pytest.mark.parametrize("kind", [np.uint8, np.int32, np.int64, bool])
def test_labels_earn_a_warning_whose_remedy_keeps_them(decimated: Decimated, kind: Any) -> None:
    V, F = decimated("cow.obj", 1000)
    labels = (V[:, 0] > np.median(V[:, 0])).astype(kind)
    _, report = filter_scalars(V, F, labels, feature_size="10%")
    assert any("if they are labels" in one for one in report["warnings"])
    names, indices = np.unique(labels, return_inverse=True)
    weights, report = filter_scalars(V, F, np.eye(len(names))[indices], feature_size="10%")
    assert not any("labels" in one for one in report["warnings"])
    smooth = names[weights.argmax(axis=1)]
    assert smooth.dtype == labels.dtype
    assert np.mean(smooth == labels) > 0.9
    inside = np.abs(V[:, 0] - np.median(V[:, 0])) > 0.1 * np.ptp(V[:, 0])
    np.testing.assert_array_equal(smooth[inside], labels[inside])


def test_numbers_that_are_no_labels_earn_no_warning(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    height = V[:, 1] / np.ptp(V[:, 1])
    for values in (
        height,
        (height > 0).astype(float),
        (1e6 * height).astype(int),
        np.ones(len(V), int),
    ):
        _, report = filter_scalars(V, F, values)
        assert not any("labels" in one for one in report["warnings"])


def test_ideal_responses_are_exact(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    Q = noisy_field(V)
    options = {"laplacian": "cotangent", "response": "ideal"}
    Y, report = filter_scalars(V, F, Q, feature_size="30%", **options)
    expected = expected_signals(V, F, Q[:, None], options, report)
    np.testing.assert_allclose(Y, expected[:, 0], rtol=0, atol=AGREEMENT * np.ptp(Q))


def test_a_power_is_that_of_the_gains(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    Q = noisy_field(V)
    half, _ = filter_scalars(V, F, Q, feature_size="15%", power=0.5)
    twice, _ = filter_scalars(V, F, half, feature_size="15%", power=0.5)
    whole, _ = filter_scalars(V, F, Q, feature_size="15%")
    np.testing.assert_allclose(twice, whole, rtol=0, atol=3 * AGREEMENT * np.ptp(Q))


@pytest.mark.parametrize("kind", ["low-pass", "sharpening", "enhancement"])
def test_colours_agree_with_scipy_to_one_level_and_alpha_is_kept(
    kind: str, sample_name: str, decimated: Decimated
) -> None:
    V, F = decimated(sample_name, 2400)
    levels = colours(V)
    mesh_set = coloured(V, F, levels)
    options = {"laplacian": "cotangent", **TYPES[kind]}
    report = mesh_set.apply_filter(COLOR, feature_size=percent(15), **options)
    found = levels_of(mesh_set)
    expected = expected_signals(V, F, levels[:, :3].astype(float), options, report)
    np.testing.assert_allclose(found[:, :3], np.clip(expected, 0, 255), rtol=0, atol=0.5001)
    np.testing.assert_array_equal(found[:, 3], levels[:, 3])
    beyond = np.rint(expected)
    assert report["clamped_values"] == ((beyond < 0) | (beyond > 255)).sum()
    assert (report["clamped_values"] > 0) == (kind != "low-pass")
    assert report["max_change"] == pytest.approx(np.abs(expected - levels[:, :3]).max(), abs=1e-3)


def test_a_fixed_boundary_keeps_its_values_and_the_rest_is_filtered(decimated: Decimated) -> None:
    V, F = lower_part(*decimated("bunny.obj"))
    V, F = V[np.unique(F)], np.unique(F, return_inverse=True)[1].reshape(-1, 3)
    Q = noisy_field(V)
    rim = reference.boundary_vertices(F)
    Y, report = filter_scalars(V, F, Q, feature_size="15%", boundary="fixed", laplacian="cotangent")
    np.testing.assert_array_equal(Y[rim], Q[rim])
    assert report["fixed_vertices"] == len(rim)
    interior = np.setdiff1d(np.arange(len(V)), rim)
    W, d = reference.matrices(V, F, "cotangent")
    spectrum = reference.fixed_spectrum(W, d, interior)
    rows = W[interior]
    H = np.linalg.solve(rows[:, interior].toarray(), -(rows[:, rim] @ Q[rim]))
    gain = gain_of({}, report)(np.sqrt(spectrum.lam))
    detail = spectrum.Phi @ (gain * (spectrum.Phi.T @ (spectrum.d * (Q[interior] - H))))
    np.testing.assert_allclose(Y[interior], H + detail, rtol=0, atol=AGREEMENT * np.ptp(Q))


def test_the_mean_of_every_component_is_kept_by_any_filter(decimated: Decimated) -> None:
    (V, F), (V2, F2) = decimated("cow.obj"), decimated("bone.ply")
    both, faces = np.vstack([V, V2 + 5]), np.vstack([F, F2 + len(V)])
    Q = noisy_field(both)
    Q[len(V) :] -= 300
    for options in TYPES.values():
        Y, report = filter_scalars(both, faces, Q, feature_size="5%", **options)
        for part in reference.components(len(both), faces):
            d = reference.lumped_areas(both, faces)[part]
            assert d @ Y[part] / d.sum() == pytest.approx(d @ Q[part] / d.sum(), abs=1e-10)
        assert report["components"] == len(reference.components(len(both), faces))


def test_noise_is_removed_and_the_field_below_it_is_kept(samples: Path) -> None:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(samples / "bunny.obj"))
    V, F = mesh_set.current_mesh().vertex_matrix(), mesh_set.current_mesh().face_matrix()
    field = np.sin(6 * (V / np.ptp(V)) @ [1.0, 2.0, -1.0])
    noise = 0.3 * np.random.default_rng(5).standard_normal(len(V))
    Y, _ = filter_scalars(V, F, field + noise, feature_size="8%")
    assert np.std(Y - field) < 0.25 * np.std(noise)


def test_after_a_deletion_only_remaining_vertices_count(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    Q = noisy_field(V)
    mesh_set = mesh_set_of(V, F, v_scalar_array=Q)
    mesh_set.compute_selection_by_condition_per_vertex(condselect="(z > 0.4)")
    mesh_set.meshing_remove_selected_vertices()
    mesh_set.apply_filter(QUALITY, feature_size=length(0.25))
    mesh = mesh_set.current_mesh()
    left = V[:, 2] <= 0.4
    assert 0 < left.sum() < len(V)
    expected, _ = filter_scalars(
        mesh.vertex_matrix(), mesh.face_matrix(), Q[left], feature_size=0.25
    )
    np.testing.assert_allclose(mesh.vertex_scalar_array(), expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("value", [np.inf, -np.inf])
def test_infinite_values_are_counted_and_located_and_the_advice_helps(
    value: float, decimated: Decimated
) -> None:
    V, F = decimated("cow.obj")
    Q = noisy_field(V)
    Q[[17, 40]] = value
    with pytest.raises(FilterError, match="2 vertices have an infinite value, the first is ver"):
        filter_scalars(V, F, Q)
    mesh_set = mesh_set_of(V, F, v_scalar_array=Q)
    before = snapshot(mesh_set.current_mesh())
    advice = "'Per Vertex Quality Function' with abs(q) < 1e30 ? q : 0/0"
    assert advice in refusal(mesh_set, QUALITY)
    assert_same(before, snapshot(mesh_set.current_mesh()))

    advised = mesh_set_of(V, F, v_scalar_array=Q)
    advised.compute_scalar_by_function_per_vertex(q="abs(q) < 1e30 ? q : 0/0")
    mended = advised.current_mesh().vertex_scalar_array()
    np.testing.assert_array_equal(mended, np.where(np.isfinite(Q), Q, np.nan))
    report = advised.apply_filter(QUALITY)
    assert report["vertices_without_data"] == 2


def test_vertices_without_data_are_treated_as_holes(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    Q = noisy_field(V)
    without = V[:, 0] > np.median(V[:, 0])
    rest = F[~without[F].any(axis=1)]
    expected, _ = filter_scalars(V, rest, Q, feature_size=0.25)
    filtered, report = filter_scalars(V, F, np.where(without, np.nan, Q), feature_size=0.25)
    assert np.isnan(filtered[without]).all()
    np.testing.assert_allclose(filtered[~without], expected[~without], rtol=0, atol=1e-12)
    assert report["vertices_without_data"] == without.sum()
    assert report["unreferenced_vertices"] == (~without).sum() - len(np.unique(rest))
    with pytest.raises(FilterError, match="no triangle has values at all of its corners"):
        filter_scalars(V, F, np.full(len(V), np.nan))


def test_several_columns_are_filtered_each_by_itself(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    hole = np.where(V[:, 2] > 0, np.nan, V[:, 0])
    Q = np.column_stack([noisy_field(V), 1e6 * V[:, 1], hole, 1e-6 * V[:, 2] ** 2, V, 1 + 0 * hole])
    Q = np.column_stack([Q, np.full(len(V), 3.0)])
    filtered, report = filter_scalars(V, F, Q, feature_size="8e")
    assert filtered.shape == Q.shape
    for column, of_column in enumerate(report["columns"]):
        alone, its_report = filter_scalars(V, F, Q[:, column], feature_size="8e")
        accuracy = 1e-6 * np.nanmax(np.abs(Q[:, column] - np.nanmean(Q[:, column])))
        np.testing.assert_allclose(filtered[:, column], alone, rtol=0, atol=accuracy)
        assert of_column["warnings"] == its_report["warnings"]
        texts = ("warnings", "warning_codes")
        for shared in ("factorizations", "solves", "error_estimate", *texts):
            del of_column[shared], its_report[shared]
        assert of_column == pytest.approx(its_report, rel=1e-5, abs=accuracy)


def test_many_columns_share_one_factorization(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    Q = np.random.default_rng(1).normal(size=(len(V), 9))
    _, report = filter_scalars(V, F, Q, feature_size="100%")
    assert {one["factorizations"] for one in report["columns"]} == {1}


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (QUALITY, "no vertex quality to filter: apply .*'Per Vertex Quality Function'"),
        (COLOR, "no vertex colours to filter: apply .*'Per Vertex Color Function'"),
    ],
)
def test_a_mesh_without_the_signal_is_refused_with_a_filter_that_makes_one(
    name: str, words: str, cow: Path
) -> None:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(cow))
    message = refusal(mesh_set, name)
    assert re.search(words, message)


@pytest.mark.parametrize("name", TARGETS)
def test_the_transfer_functions_parameters_are_those_of_the_main_filter(
    name: str, decimated: Decimated
) -> None:
    mesh_set = mesh_set_of(*decimated("cow.obj"))
    ours, main = (mesh_set.filter_parameter_values(each) for each in (name, FILTER))
    assert ours.items() <= main.items()
    assert [each for each in main if each in ours] == list(ours)
    assert list(ours)[: list(ours).index("laplacian")] == list(main)[: list(main).index("steps")]


def test_arrays_of_the_wrong_shape_are_refused() -> None:
    V, F = TRIANGLE
    for values in (np.zeros(2), np.zeros((2, 3)), 1.0):
        with pytest.raises(ValueError, match="pass 3 numbers"):
            filter_scalars(V, F, values)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"steps": 3}, "steps: not for values"),
        ({"spectrum": "full"}, "spectrum: not for values"),
        ({"feature_sise": "2%"}, "did you mean feature_size"),
        ({"order": 65}, "order = 65"),
    ],
)
def test_options_of_other_filters_and_unknown_ones_are_refused(
    options: dict[str, Any], words: str
) -> None:
    V, F = TRIANGLE
    with pytest.raises(OptionError, match=words):
        filter_scalars(V, F, np.arange(3.0), **options)


def test_a_missed_accuracy_or_nothing_to_filter_is_a_warning(decimated: Decimated) -> None:
    V, F = TRIANGLE
    Y, report = filter_scalars(V, F, [1.0, 2.0, 4.0], boundary="fixed")
    np.testing.assert_array_equal(Y, [1.0, 2.0, 4.0])
    assert len(report["warnings"]) == 1
    assert report["warnings"][0].startswith("nothing can change")

    Y, report = filter_scalars(V, F, [0.1, 0.1, 0.1])
    np.testing.assert_array_equal(Y, [0.1, 0.1, 0.1])
    assert len(report["warnings"]) == 1
    assert report["warnings"][0].startswith("nothing to filter")

    V, F = decimated("cow.obj")
    steep = FilterOptions(
        filter_type="custom", transfer_function="abs(w - 1)", power=0.05, feature_size="15%"
    )
    _, report = filter_scalars(V, F, noisy_field(V), steep)
    assert not report["accuracy_reached"]
    assert "accuracy of 1e-06 was not reached" in report["warnings"][0]
    assert "steps" not in report["warnings"][0]


@pytest.mark.parametrize(
    ("gain", "expression"),
    [
        (lambda w: 1 / (1 + w**4), "1/(1 + w^4)"),
        (lambda w: 1 + w**2 * np.exp(-(w**2)), "1 + w^2*exp(-w^2)"),
    ],
)
def test_a_smooth_gain_is_as_accurate_as_its_expression(
    gain: Any, expression: str, decimated: Decimated
) -> None:
    V, F = decimated("bunny.obj")
    field = noisy_field(V)
    given, report = filter_scalars(V, F, field, gain=gain)
    assert report["accuracy_reached"]
    assert report["warnings"] == []
    options = FilterOptions(filter_type="custom", transfer_function=expression)
    expected, _ = filter_scalars(V, F, field, options)
    assert np.abs(given - expected).max() < 2e-6 * np.abs(field - field.mean()).max()


@pytest.mark.parametrize(
    "options",
    [
        {"pass_gain": 1e30},
        {"filter_type": "band-pass", "band_width": 1e-3, "pass_gain": 90.0, "stop_gain": 1.0},
        {"response": "ideal"},
    ],
    ids=str,
)
def test_a_gain_out_of_reach_is_refused_recommending_only_options_of_the_filter(
    options: dict[str, Any], samples: Path
) -> None:
    loaded = pymeshlab.MeshSet()
    loaded.load_new_mesh(str(samples / "bunny.obj"))
    V, F = loaded.current_mesh().vertex_matrix(), loaded.current_mesh().face_matrix()
    mesh_set = mesh_set_of(V, F, v_scalar_array=noisy_field(V))
    main, ours = (mesh_set.filter_parameter_values(name) for name in (FILTER, QUALITY))
    before = snapshot(mesh_set.current_mesh())
    message = refusal(mesh_set, QUALITY, **options)
    assert_same(before, snapshot(mesh_set.current_mesh()))
    assert "choose" in message
    assert not [name for name in main.keys() - ours.keys() if re.search(rf"\b{name}\b", message)]


def test_a_bump_is_reduced_as_the_readme_says() -> None:
    width = 0.1
    plane = pyvista.Plane(i_resolution=160, j_resolution=160).triangulate()
    x, y, _ = np.asarray(plane.points, dtype=np.float64).T
    r = np.hypot(x, y)
    lone = np.where(r < width / 2, (1 + np.cos(2 * np.pi * r / width)) / 2, 0.0)
    waves = np.cos(np.pi * x / width)  # a bump and a hollow: a wavelength of two widths

    def left(field: Array, widths: float) -> float:
        return filter_scalars(plane, values=field, feature_size=widths * width)[0][r.argmin()]

    assert left(lone, 4) == pytest.approx(1 / 8, abs=0.01)
    for widths, height in ((1, 0.92), (2, 0.71), (4, 0.25), (6, 0.04)):
        assert left(waves, widths) == pytest.approx(height, abs=0.01)


def test_fwhm_is_the_width_at_half_height_of_what_becomes_of_a_point() -> None:
    cells, fwhm = 100, 12.0
    grid = pyvista.Plane(i_size=cells, j_size=cells, i_resolution=cells, j_resolution=cells)
    grid = grid.triangulate()
    V, F = np.asarray(grid.points, dtype=np.float64), grid.regular_faces
    r = np.linalg.norm(V, axis=1)
    smooth, _ = filter_scalars(V, F, (r == 0).astype(float), fwhm=fwhm)
    top = smooth.max()
    np.testing.assert_allclose(smooth / top, 2 ** -((2 * r / fwhm) ** 2), atol=0.01)
    by_size, _ = filter_scalars(V, F, (r == 0).astype(float), feature_size=3.2049 * fwhm)
    np.testing.assert_allclose(by_size, smooth, atol=1e-4 * top)


@pytest.mark.parametrize(
    "wrong",
    [
        {"fwhm": 0.0},
        {"fwhm": -1.0},
        {"fwhm": np.nan},
        {"fwhm": np.inf},
        {"fwhm": "2%"},
        {"fwhm": np.array([1.0, 2.0])},
        {"fwhm": 1.0, "feature_size": 2.0},
        {"fwhm": 1.0, "filter_type": "high-pass"},
        {"fwhm": 1.0, "response": "ideal"},
        {"fwhm": 1.0, "gain": np.ones_like},
        {"fwhm": 1.0, "options": FilterOptions()},
    ],
)
def test_a_fwhm_that_is_no_width_or_contradicts_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(OptionError, match="fwhm"):
        filter_scalars(*TRIANGLE, np.arange(3.0), **wrong)
