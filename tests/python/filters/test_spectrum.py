"""The geometry spectrum is what an independent implementation with all eigenvectors computes."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
import spectral_reference as reference
from helpers import assert_same, diagonal, filter_arrays, length, lower_part, mesh_set_of, snapshot
from meshlab_spectral import (
    FilterError,
    GeometrySpectrum,
    OptionError,
    denoise_mesh,
    geometry_spectrum,
)
from meshlab_spectral.files.meshes import load_arrays
from numpy.typing import NDArray
from shared_types import Decimated, SharedMesh

OCTAVES = 1e-2  # relative accuracy of an octave's energy


def reference_spectrum(
    V: NDArray[Any], F: NDArray[Any], laplacian: str
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Frequencies and energies of all harmonics, constants without energy; and the area."""
    W, d = reference.matrices(V, F, laplacian)
    omega, energy = [], []
    for part in reference.spectra(W, d, reference.components(len(V), F)):
        c = part.Phi.T @ (part.d[:, None] * V[part.of])
        c[0] = 0
        omega.append(np.sqrt(part.lam))
        energy.append((c**2).sum(axis=1))
    frequencies, energies = np.concatenate(omega), np.concatenate(energy)
    order = np.argsort(frequencies, kind="stable")
    return frequencies[order], energies[order], float(d.sum())


def octave_energies(
    sizes: NDArray[np.float64], omega: NDArray[np.float64], energy: NDArray[np.float64]
) -> list[float]:
    """Energies of octaves with these centres, which cross-fade as cos^2 over half an octave."""
    with np.errstate(divide="ignore"):
        x = -np.log2(2 * np.pi / omega / sizes[0])  # octaves from the first centre
    result = []
    for j in range(len(sizes)):
        rise = np.sin(np.pi / 2 * np.clip(2 * (x - j + 0.5) + 0.5, 0, 1)) ** 2 if j else 1.0
        fall = np.sin(np.pi / 2 * np.clip(2 * (x - j - 0.5) + 0.5, 0, 1)) ** 2
        fall = fall if j < len(sizes) - 1 else 0.0
        result.append(float(np.sum((rise - fall) * energy)))
    return result


@pytest.mark.parametrize("laplacian", ["cotangent", "intrinsic delaunay"])
@pytest.mark.parametrize("basis_size", [0, 10, 200])
def test_frequencies_energies_and_feature_sizes_agree(
    sample_name: str, basis_size: int, laplacian: Any, decimated: Decimated
) -> None:
    V, F = decimated(sample_name)
    omega, energy, area = reference_spectrum(V, F, laplacian)
    found = geometry_spectrum(V, F, basis_size, laplacian)

    k = len(found.frequencies)
    assert basis_size <= k < basis_size + 20
    np.testing.assert_allclose(found.frequencies, omega[:k], rtol=1e-6, atol=1e-6 * omega[k])
    # Harmonics of nearly equal frequency may mix: the energies of all of them do not.
    np.testing.assert_allclose(
        np.cumsum(found.amplitudes**2), np.cumsum(energy[:k]) / area, rtol=1e-5
    )
    assert found.diagonal == pytest.approx(diagonal(V), rel=1e-12)
    assert found.area == pytest.approx(area, rel=1e-12)
    assert found.total_energy == pytest.approx(energy.sum(), rel=1e-9)

    expected = octave_energies(found.octave_feature_sizes, omega, energy)
    np.testing.assert_allclose(found.octave_energies, expected, rtol=OCTAVES)
    assert found.octave_energies.sum() == pytest.approx(energy.sum(), rel=1e-9)
    np.testing.assert_allclose(
        found.octave_amplitudes, np.sqrt(found.octave_energies / area), rtol=1e-12
    )
    np.testing.assert_allclose(
        found.cumulative_energy, np.cumsum(found.octave_energies) / energy.sum(), rtol=1e-9
    )
    for share, size in (
        (0.5, found.feature_size_50),
        (0.9, found.feature_size_90),
        (0.99, found.feature_size_99),
    ):
        exact = 2 * np.pi / omega[np.searchsorted(np.cumsum(energy), share * energy.sum())]
        within_basis = k > 0 and exact > 1.001 * 2 * np.pi / omega[k - 1]
        assert abs(np.log2(size / exact)) < (1e-4 if within_basis else 0.75)


@pytest.mark.parametrize("laplacian", ["cotangent", "intrinsic delaunay"])
@pytest.mark.parametrize("basis_size", [0, 10, 200])
def test_a_fixed_boundary_leaves_what_the_boundary_does_not_determine(
    sample_name: str, basis_size: int, laplacian: Any, decimated: Decimated
) -> None:
    V, F = lower_part(*decimated(sample_name))
    W, d = reference.matrices(V, F, laplacian)
    rim = reference.boundary_vertices(F)
    interior = np.setdiff1d(np.arange(len(V)), rim)
    rows = W[interior].toarray()
    harmonic = np.linalg.solve(rows[:, interior], -rows[:, rim] @ V[rim])
    part = reference.fixed_spectrum(W, d, interior)
    coefficients = part.Phi.T @ (part.d[:, None] * (V[interior] - harmonic))
    omega, energy = np.sqrt(part.lam), (coefficients**2).sum(axis=1)

    found = geometry_spectrum(V, F, basis_size, laplacian, "fixed")
    k = len(found.frequencies)
    assert basis_size <= k < basis_size + 20
    np.testing.assert_allclose(found.frequencies, omega[:k], rtol=1e-6)
    np.testing.assert_allclose(
        np.cumsum(found.amplitudes**2), np.cumsum(energy[:k]) / d.sum(), rtol=1e-4
    )
    assert found.area == pytest.approx(d.sum(), rel=1e-12)
    assert found.total_energy == pytest.approx(energy.sum(), rel=1e-9)
    expected = octave_energies(found.octave_feature_sizes, omega, energy)
    np.testing.assert_allclose(found.octave_energies, expected, rtol=OCTAVES)


def test_a_fixed_boundary_that_leaves_nothing_is_refused() -> None:
    flat = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.4, 0.3, 0]]
    for faces in ([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], [[0, 1, 2], [0, 2, 3]]):
        with pytest.raises(FilterError, match="boundary = free"):
            geometry_spectrum(flat, faces, laplacian="cotangent", boundary="fixed")


def test_octaves_are_powers_of_two_of_the_diagonal_and_hold_all_frequencies(
    sample_name: str, decimated: Decimated
) -> None:
    V, F = decimated(sample_name)
    omega, _, _ = reference_spectrum(V, F, "intrinsic delaunay")
    found = geometry_spectrum(V, F, 20)
    powers = np.log2(found.octave_feature_sizes / diagonal(V))
    np.testing.assert_allclose(powers, np.round(powers), atol=1e-12)
    np.testing.assert_allclose(np.diff(powers), -1, atol=1e-12)
    largest, smallest = 2 * np.pi / omega[[1, -1]]
    assert abs(np.log2(found.octave_feature_sizes[0] / largest)) <= 0.5001
    assert abs(np.log2(found.octave_feature_sizes[-1] / smallest)) <= 0.5001


def test_noise_shows_in_the_small_octaves_with_its_height_and_nowhere_else(
    decimated: Decimated,
) -> None:
    V, F = decimated("bone.ply")
    before = geometry_spectrum(V, F, 50)
    height = 0.003 * before.diagonal
    normals = np.zeros_like(V)
    a, b, c = (V[F[:, corner]] for corner in range(3))
    np.add.at(normals, F, np.cross(b - a, c - a)[:, None])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    noise = height * np.random.default_rng(1).standard_normal((len(V), 1)) * normals
    after = geometry_spectrum(V + noise, F, 50)
    large = before.octave_feature_sizes > 0.2 * before.diagonal
    total = [np.linalg.norm(each.octave_amplitudes[: large.sum()]) for each in (before, after)]
    assert total[1] == pytest.approx(total[0], rel=0.02)
    small = [np.linalg.norm(each.octave_amplitudes[-2:]) for each in (before, after)]
    # Not all of it: some of the noise has longer waves.
    assert 0.8 * height < np.sqrt(small[1] ** 2 - small[0] ** 2) < 1.05 * height


@pytest.mark.parametrize("percent", [0.15, 0.18])
def test_the_height_and_feature_size_of_noise_are_reported(
    percent: float, decimated: Decimated
) -> None:
    V, F = decimated("bunny.obj", 10000)
    smooth, _ = filter_arrays(V, F, feature_size=length(0.06 * diagonal(V)), steps=1)
    # Details of a third of that size are almost gone.
    height = percent / 100 * diagonal(V)
    noise = height * np.random.default_rng(2).standard_normal(V.shape)
    found = geometry_spectrum(smooth + noise, F, 100)
    assert found.noise_height == pytest.approx(height, rel=0.2)
    removed = denoise_mesh(smooth + noise, F)[1]["noise_height"]
    assert found.noise_height == pytest.approx(removed, rel=1e-9)
    assert 0.02 < found.noise_feature_size / found.diagonal < 0.08
    below = found.band_feature_sizes < 0.8 * found.noise_feature_size
    assert below.sum() >= 3
    np.testing.assert_allclose(found.noise_heights[below], height, rtol=0.35)
    clean = geometry_spectrum(smooth, F, 100)
    assert clean.noise_height == clean.noise_feature_size == 0


def test_noise_in_a_range_scan_is_distinguished_from_its_relief_and_its_rim(
    shared_mesh: SharedMesh,
) -> None:
    V, F = load_arrays(shared_mesh("rangescan_lato000.ply"))
    raw = geometry_spectrum(V, F, 50, boundary="fixed")
    assert raw.noise_height == raw.noise_feature_size == 0
    assert raw.noise_summary.startswith("found no noise")
    height = 0.05
    noisy = V + height * np.random.default_rng(4).standard_normal(V.shape)
    found = geometry_spectrum(noisy, F, 50, boundary="fixed")
    assert found.noise_height == pytest.approx(height, rel=0.15)
    # Three edges and more; smaller than most of the relief.
    assert 0.008 < found.noise_feature_size / found.diagonal < 0.02
    assert found.noise_summary.startswith("white noise: height 0.094 edges")  # .092 in truth


@pytest.mark.parametrize("basis_size", [0, 10, 200])
def test_the_bands_agree(sample_name: str, basis_size: int, decimated: Decimated) -> None:
    V, F = decimated(sample_name)
    W, d = reference.matrices(V, F, "cotangent")
    omega, energy, area = reference_spectrum(V, F, "cotangent")
    parts = reference.spectra(W, d, reference.components(len(V), F))
    frequencies = np.concatenate([np.sqrt(part.lam) for part in parts])
    # The mean energy over all draws of noise of height 1, without the constants.
    noise = np.concatenate(
        [
            ((part.d[:, None] * part.Phi) ** 2).sum(axis=0) * (np.arange(len(part.lam)) > 0)
            for part in parts
        ]
    )
    found = geometry_spectrum(V, F, basis_size, "cotangent")
    assert len(found.band_feature_sizes) > 3
    for size, amplitude, of_noise in zip(
        found.band_feature_sizes[1:-1],  # the first and the last may be open to one side
        found.band_amplitudes[1:-1],
        found.band_noise[1:-1],
        strict=True,
    ):
        shape, mean = (
            np.sqrt(np.sum(third_window(size, w) * e) / area)
            for w, e in ((omega, energy), (frequencies, noise))
        )
        assert amplitude == pytest.approx(shape, rel=0.02)
        assert of_noise == pytest.approx(mean, rel=0.35)  # a single draw over 30 harmonics or more


def third_window(size: float, omega: NDArray[np.float64]) -> NDArray[np.float64]:
    """Window of a third of an octave about a feature size: cos^2, 0 at a third to each side."""
    with np.errstate(divide="ignore"):
        thirds = np.abs(3 * np.log2(omega * size / (2 * np.pi)))
    return np.asarray(np.cos(np.pi / 2 * np.minimum(thirds, 1)) ** 2)


def test_the_filter_reports_everything_and_leaves_the_mesh_unchanged(decimated: Decimated) -> None:
    mesh_set = mesh_set_of(*decimated("cow.obj"))
    before = snapshot(mesh_set.current_mesh())
    report = mesh_set.get_geometry_spectrum(basis_size=30)
    assert report.keys() == {f.name for f in fields(GeometrySpectrum)} - {"noise_summary"}
    assert_same(before, snapshot(mesh_set.current_mesh()))


def test_a_small_mesh_has_all_of_its_harmonics() -> None:
    found = geometry_spectrum([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 10)
    assert found.frequencies.shape == (3,)
    assert found.octave_energies.sum() == pytest.approx(found.total_energy)
    assert found.band_feature_sizes.shape == found.noise_heights.shape == (0,)
    assert found.noise_height == found.noise_feature_size == 0


def test_a_basis_as_large_as_a_large_mesh_is_refused(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj", 5000)
    with pytest.raises(FilterError, match=f"choose at most {len(V) - 1}"):
        geometry_spectrum(V, F, len(V))


@pytest.mark.parametrize("basis_size", [-1, 2.5, True, "ten", 2**31])
def test_an_invalid_basis_size_is_refused(basis_size: Any) -> None:
    with pytest.raises(OptionError, match="basis_size"):
        geometry_spectrum([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], basis_size)


def test_an_unknown_choice_is_refused_with_the_known_ones(decimated: Decimated) -> None:
    unknown: Any = "graph"
    with pytest.raises(OptionError, match="intrinsic delaunay, cotangent"):
        geometry_spectrum(*decimated("cow.obj"), laplacian=unknown)
    with pytest.raises(OptionError, match="free, fixed"):
        geometry_spectrum(*decimated("cow.obj"), boundary=unknown)


def test_a_mesh_that_cannot_be_measured_is_refused(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    with pytest.raises(FilterError, match="no faces"):
        geometry_spectrum(V, F[:0])
    with pytest.raises(ValueError, match="vertex"):
        geometry_spectrum(V, F + len(V))
