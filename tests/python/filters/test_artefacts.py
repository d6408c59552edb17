"""The artefact measure is what an independent implementation with all eigenvectors computes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import spectral_reference as reference
from helpers import assert_same, diagonal, mesh_set_of, percent, snapshot
from meshlab_spectral import Artefacts, FilterError, OptionError, measure_artefacts
from numpy.typing import NDArray
from shared_types import Decimated

AGREEMENT = 1e-7  # of the diagonal of the bounding box; parameters go through 32-bit floats


TRIANGLE = (np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))


def expected_lengths(
    V: NDArray[Any], F: NDArray[Any], feature_size: float, laplacian: str
) -> NDArray[np.float64]:
    """Lengths of X - g(A) X with all eigenvectors."""
    lam_c = (2 * np.pi / feature_size) ** 2
    W, d = reference.matrices(V, F, laplacian)
    spectrum = reference.spectra(W, d, reference.components(len(V), F))
    smooth = reference.apply_gain(
        V, spectrum, lambda omega: 1 / (1 + (omega**2 / (4 * lam_c)) ** 4)
    )
    return np.linalg.norm(V - smooth, axis=1)


@pytest.mark.parametrize("laplacian", ["cotangent", "intrinsic delaunay"])
@pytest.mark.parametrize("part", [0.2, 0.5])
def test_lengths_rms_and_maximum_agree(
    sample_name: str, part: float, laplacian: Any, decimated: Decimated
) -> None:
    V, F = decimated(sample_name)
    size = part * diagonal(V)
    found = measure_artefacts(V, F, size, laplacian)
    expected = expected_lengths(V, F, size, laplacian)
    d = reference.lumped_areas(V, F)
    tolerance = AGREEMENT * diagonal(V)
    assert expected.max() > 1e-3 * diagonal(V), "a mesh without artefacts tests nothing"
    np.testing.assert_allclose(found.length, expected, rtol=0, atol=tolerance)
    assert found.maximum == pytest.approx(expected.max(), abs=tolerance)
    assert found.rms == pytest.approx(np.sqrt(d @ expected**2 / d.sum()), abs=tolerance)
    assert found.diagonal == pytest.approx(diagonal(V), rel=1e-12)


def test_two_factorizations_give_what_all_eigenvectors_give(
    sample_name: str, decimated: Decimated
) -> None:
    V, F = decimated(sample_name)
    size = 0.2 * diagonal(V)
    found = reference.artefacts(V, F, size, reference.lumped_areas(V, F))
    expected = expected_lengths(V, F, size, "intrinsic delaunay")
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * diagonal(V))


def test_artefacts_scale_with_the_mesh_and_do_not_change_under_translation(
    decimated: Decimated,
) -> None:
    V, F = decimated("bone.ply")
    before = measure_artefacts(V, F, 0.15 * diagonal(V))
    after = measure_artefacts(1e3 * V + [5, -7, 9], F, 1e3 * 0.15 * diagonal(V))
    np.testing.assert_allclose(after.length, 1e3 * before.length, rtol=0, atol=1e-4 * diagonal(V))
    assert after.rms == pytest.approx(1e3 * before.rms, rel=1e-5)


def test_vertices_without_faces_have_no_artefacts(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    found = measure_artefacts(np.vstack([V, V[:1] + 0.01]), F, 0.15 * diagonal(V))
    assert len(found.length) == len(V) + 1
    assert found.length[-1] == 0


def test_the_filter_fills_quality_and_colours_and_moves_nothing(decimated: Decimated) -> None:
    mesh_set = mesh_set_of(*decimated("cow.obj"))
    mesh = mesh_set.current_mesh()
    before = snapshot(mesh)
    report = mesh_set.compute_scalar_spectral_artefacts_per_vertex(feature_size=percent(15))
    assert report.keys() == {"rms", "maximum", "feature_size", "diagonal"}
    assert report["feature_size"] == pytest.approx(0.15 * report["diagonal"], rel=1e-6)
    quality = mesh.vertex_scalar_array()
    assert quality.max() == report["maximum"]
    assert quality.min() >= 0
    part = quality / (0.1 * report["feature_size"])
    assert part.max() > 0.5
    colours = 255 * mesh.vertex_color_matrix()
    for channel, levels in enumerate([(255, 253, 128), (255, 141, 0), (255, 60, 38)]):
        expected = np.interp(part, [0, 0.5, 1], levels)  # white, orange, dark red
        np.testing.assert_allclose(colours[:, channel], expected, rtol=0, atol=0.51)
    after = snapshot(mesh)
    for name in ("vertex_scalar_array", "vertex_color_matrix"):
        before.pop(name, None)
        del after[name]
    assert_same(before, after)


@pytest.mark.parametrize("feature_size", [0.0, -1.0, float("nan"), float("inf"), 1e39, "500%"])
def test_an_invalid_feature_size_is_refused_by_name(feature_size: Any) -> None:
    with pytest.raises(OptionError, match="feature_size"):
        measure_artefacts(*TRIANGLE, feature_size)


def test_an_unknown_laplacian_is_refused_with_the_choices() -> None:
    with pytest.raises(OptionError, match="intrinsic delaunay, cotangent, uniform"):
        measure_artefacts(*TRIANGLE, 1.0, "umbrella")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("vertices", "faces", "named"),
    [
        (np.zeros((3, 2)), TRIANGLE[1], r"shape \(3, 2\)"),
        (np.zeros((0, 3)), np.zeros((0, 3), dtype=int), "no vertices"),
        (TRIANGLE[0], np.array([[0, 1, 2, 0]]), r"shape \(1, 4\)"),
        (TRIANGLE[0], np.array([[0.0, 1.0, 2.0]]), "float64"),
        (TRIANGLE[0], np.array([[0, 1, 3]]), "vertex 3"),
        (TRIANGLE[0], np.array([[0, 1, -1]]), "vertex -1"),
    ],
)
def test_arrays_that_are_not_a_mesh_are_refused(
    vertices: NDArray[Any], faces: NDArray[Any], named: str
) -> None:
    with pytest.raises(ValueError, match=named):
        measure_artefacts(vertices, faces, 1.0)


def test_a_mesh_that_cannot_be_measured_is_refused_with_the_plugins_reason() -> None:
    V, F = TRIANGLE
    with pytest.raises(FilterError, match="no faces"):
        measure_artefacts(V, F[:0], 1.0)
    with pytest.raises(FilterError, match="vertex 1"):
        measure_artefacts([[0, 0, 0], [np.nan, 0, 0], [0, 1, 0]], F, 1.0)


def test_lists_are_accepted() -> None:
    found = measure_artefacts([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 1.0)
    assert isinstance(found, Artefacts)
    assert found.length.shape == (3,)


def test_a_size_may_be_relative_to_the_mesh(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    corners = V[F]
    edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean()
    for text, length in (("20%", 0.2 * diagonal(V)), ("6e", 6 * edge)):
        found, expected = measure_artefacts(V, F, text), measure_artefacts(V, F, length)
        assert found.rms == pytest.approx(expected.rms, rel=1e-5)
    for wrong in ("auto", "much", "0%"):
        with pytest.raises(OptionError, match="feature_size = "):
            measure_artefacts(V, F, wrong)
