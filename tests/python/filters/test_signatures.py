"""Projections, signatures and shape-DNA: closed forms, identities, SciPy, errors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import spectral_reference as reference
from helpers import lower_part
from meshlab_spectral import FilterError, Harmonics, OptionError, manifold_harmonics, shape_dna
from meshlab_spectral.filters.harmonics import heat_times, wave_energies
from numpy.typing import NDArray
from shapes import sphere

Array = NDArray[np.float64]
Mesh = tuple[NDArray[Any], NDArray[Any]]
Decimated = Callable[..., Mesh]

DEGREE = 6  # spherical harmonics up to this one: (DEGREE + 1)^2 functions


@pytest.fixture(scope="module")
def spheres() -> list[tuple[int, Harmonics]]:
    """Harmonics of icospheres, each of half the edge length of the one before."""
    meshes = [sphere(subdivisions) for subdivisions in (3, 4)]
    return [(len(V), manifold_harmonics(V, F, (DEGREE + 1) ** 2)) for V, F in meshes]


@pytest.fixture(scope="module")
def bunny(decimated: Decimated) -> tuple[Array, Harmonics]:
    V, F = decimated("bunny.obj")
    return V, manifold_harmonics(V, F, 60)


def closed_form_heat(t: Array) -> Array:
    """Sum of (2 l + 1) exp(-l (l + 1) t) / (4 pi), the same at every point of the unit sphere."""
    degree = np.arange(DEGREE + 1)[:, None]
    terms = (2 * degree + 1) * np.exp(-degree * (degree + 1) * t) / (4 * np.pi)
    return np.asarray(terms.sum(axis=0))


def test_the_heat_kernel_signature_of_a_sphere_converges_to_its_closed_form(
    spheres: list[tuple[int, Harmonics]],
) -> None:
    times = np.geomspace(0.05, 2, 7)
    errors = []
    for n, basis in spheres:
        found = basis.heat_kernel_signature(times)
        assert found.shape == (n, 7)
        errors.append(np.abs(found / closed_form_heat(times) - 1).max())
    assert errors[1] < 0.01
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15), "second order"


def test_the_wave_kernel_signature_of_a_sphere_is_constant(
    spheres: list[tuple[int, Harmonics]],
) -> None:
    errors = []
    for n, basis in spheres:
        found = basis.wave_kernel_signature(20)
        assert found.shape == (n, 20)
        error = 4 * np.pi * found - 1
        assert np.abs(error).max() < 0.05
        # Mean square: at the twelve vertices of degree 5 the order is a little less.
        errors.append(np.sqrt(np.average((error**2).mean(axis=1), weights=basis.masses)))
    assert errors[1] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15), "second order"


def test_shape_dna_of_a_sphere_is_that_of_spherical_harmonics() -> None:
    degree = np.repeat(np.arange(4), 2 * np.arange(4) + 1)
    V, F = sphere(4)
    for radius in (1.0, 250.0):
        dna = shape_dna(radius * V, F, 16)
        np.testing.assert_allclose(dna, 4 * np.pi * degree * (degree + 1), rtol=5e-3)
    unscaled = shape_dna(10 * V, F, 16, normalize=False)
    np.testing.assert_allclose(unscaled, degree * (degree + 1) / 100, rtol=5e-3)


def test_shape_dna_entries_do_not_depend_on_size_position_or_count(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    dna = shape_dna(V, F, 30)
    assert dna.shape == (30,)
    np.testing.assert_allclose(shape_dna(1e-3 * V @ turn + 7, F, 30), dna, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(shape_dna(V, F, 12), dna[:12], rtol=1e-9, atol=1e-9)


def test_shape_dna_of_parts_is_that_of_the_laplacian_with_its_boundary_condition(
    decimated: Decimated,
) -> None:
    V, F = lower_part(*decimated("cow.obj"))
    W, d = reference.matrices(V, F, "cotangent")
    interior = np.setdiff1d(np.arange(len(V)), reference.boundary_vertices(F))
    lam = reference.fixed_spectrum(W, d, interior).lam[:10]
    dna = shape_dna(V, F, 10, laplacian="cotangent", boundary="fixed")
    np.testing.assert_allclose(dna, lam * d.sum(), rtol=1e-7)
    assert dna[0] > 0


def test_projection_is_orthogonal_and_reconstruction_its_inverse_in_the_basis(
    bunny: tuple[Array, Harmonics],
) -> None:
    V, basis = bunny
    random = np.random.default_rng(1)
    c = random.normal(size=(60, 2))
    np.testing.assert_allclose(basis.project(basis.reconstruct(c)), c, rtol=0, atol=1e-8)
    np.testing.assert_allclose(basis.project(V[:, 0]), basis.project(V)[:, 0], atol=1e-12)
    assert basis.project(V).shape == (60, 3)
    assert basis.reconstruct(c[:, 0]).shape == (len(V),)

    f = random.normal(size=len(V))
    inside = basis.reconstruct(basis.project(f))
    np.testing.assert_allclose(basis.project(f - inside), 0, rtol=0, atol=1e-10)
    energies = [basis.masses @ g**2 for g in (f, inside, f - inside)]
    assert energies[0] == pytest.approx(energies[1] + energies[2])
    assert energies[1] == pytest.approx((basis.project(f) ** 2).sum())


def test_filter_agrees_with_its_definition_by_scipy(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    W, d = reference.matrices(V, F, "cotangent")
    (part,) = reference.spectra(W, d, reference.components(len(V), F))
    cutoff = np.sqrt(part.lam[15])
    f = np.column_stack([V, np.random.default_rng(2).normal(size=len(V))])

    k = 40
    gaps = np.diff(part.lam[k - 1 : k + 1]) / part.lam[k]
    assert gaps > 1e-4, "the basis ends within equal eigenvalues"
    Phi, lam = part.Phi[:, :k], part.lam[:k]
    gains = np.append(1, 2 * np.exp(-lam[1:] / cutoff**2))
    expected = Phi @ (gains[:, None] * (Phi.T @ (d[:, None] * f)))

    basis = manifold_harmonics(V, F, k, "cotangent")
    found = basis.filter(f, lambda omega: 2 * np.exp(-((omega / cutoff) ** 2)))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-7 * np.abs(expected).max())
    alone = basis.filter(f[:, 3], lambda omega: 2 * np.exp(-((omega / cutoff) ** 2)))
    np.testing.assert_allclose(alone, found[:, 3], rtol=0, atol=1e-12)


def test_filter_keeps_the_mean_of_every_component_whatever_the_gain(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    n = len(V)
    two = np.vstack([V, 2 * V + 10]), np.vstack([F, F + n])
    basis = manifold_harmonics(*two, 20)
    f = two[0][:, 0] ** 2
    asked: list[Array] = []

    def nothing(omega: Array) -> float:
        asked.append(omega)
        return 0.0

    found = basis.filter(f, nothing)
    for part in (slice(0, n), slice(n, 2 * n)):
        mean = np.average(f[part], weights=basis.masses[part])
        np.testing.assert_allclose(found[part], mean, rtol=1e-9)
    (omega,) = asked
    np.testing.assert_array_equal(omega, basis.frequencies[2:])
    assert omega[0] > 0


def test_signatures_agree_with_their_definitions(bunny: tuple[Array, Harmonics]) -> None:
    _, basis = bunny
    lam, Phi = basis.eigenvalues, basis.harmonics
    times = [0.0, 0.1 / lam[5], 1 / lam[5]]
    heat = [[sum(np.exp(-lam * t) * Phi[x] ** 2) for t in times] for x in (0, 100)]
    np.testing.assert_allclose(basis.heat_kernel_signature(times)[[0, 100]], heat, rtol=1e-10)

    T = 30
    e = [np.log(lam[1]) + (14 + j) * np.log(lam[-1] / lam[1]) / (T + 27) for j in range(T)]
    sigma = 7 * (e[1] - e[0])
    assert e[0] == pytest.approx(np.log(lam[1]) + 2 * sigma)
    assert e[-1] == pytest.approx(np.log(lam[-1]) - 2 * sigma)
    weights = [np.exp(-((each - np.log(lam[1:])) ** 2) / (2 * sigma**2)) for each in e]
    wave = [[w @ Phi[x, 1:] ** 2 / w.sum() for w in weights] for x in (0, 100)]
    np.testing.assert_allclose(basis.wave_kernel_signature(T)[[0, 100]], wave, rtol=1e-9)


def test_signatures_integrate_to_the_heat_trace_and_to_one(bunny: tuple[Array, Harmonics]) -> None:
    V, basis = bunny
    heat, wave = basis.heat_kernel_signature(), basis.wave_kernel_signature()
    assert heat.shape == (len(V), 16)
    assert wave.shape == (len(V), 100)
    assert (heat > 0).all()
    assert (np.diff(heat, axis=1) < 0).all(), "heat spreads"
    np.testing.assert_allclose(basis.masses @ wave, 1, rtol=1e-8)
    # The trace of the heat kernel.
    t = heat_times(basis.eigenvalues, 16)
    trace = np.exp(-np.outer(basis.eigenvalues, t)).sum(axis=0)
    np.testing.assert_allclose(basis.masses @ heat, trace, rtol=1e-8)
    faded = np.exp(-basis.eigenvalues[[-1, 1]] * t[[0, -1]])
    np.testing.assert_allclose(faded, 1e-4, rtol=1e-9)


def test_signatures_scale_as_one_over_area(decimated: Decimated) -> None:
    V, F = decimated("bunny.obj", 1000)
    one, large = manifold_harmonics(V, F, 20), manifold_harmonics(1000 * V, F, 20)
    for signature in (Harmonics.heat_kernel_signature, Harmonics.wave_kernel_signature):
        np.testing.assert_allclose(1e6 * signature(large), signature(one), rtol=1e-5)


def test_energies_far_from_all_eigenvalues_have_a_finite_signature() -> None:
    lam = np.array([0.0, 1.0, 1e12])
    found = Harmonics(lam, np.ones((1, 3)), np.ones(1)).wave_kernel_signature(2000)
    np.testing.assert_allclose(found, 1, rtol=1e-12)


def test_one_energy_is_in_the_middle_of_the_spectrum() -> None:
    e, sigma = wave_energies(np.array([0.0, np.exp(1.0), np.exp(5.0)]), 1)
    assert e == pytest.approx([3])
    assert sigma == pytest.approx(1)


def test_at_unreferenced_vertices_signatures_are_zero(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    basis = manifold_harmonics(np.vstack([V, [[0, 0, 9]]]), F, 10)
    assert (basis.heat_kernel_signature()[-1] == 0).all()
    assert (basis.wave_kernel_signature()[-1] == 0).all()
    assert basis.filter(np.ones(len(V) + 1), np.ones_like)[-1] == 0


REFUSED: dict[str, tuple[Callable[[Harmonics], Any], str]] = {
    "too few values": (lambda basis: basis.project(np.ones(5)), "f has shape .5,.: pass 602"),
    "a number": (lambda basis: basis.project(1.0), "f has shape"),
    "no data": (lambda basis: basis.project(np.full((602, 2), np.nan)), "f is not .* vertex 0"),
    "columns": (lambda basis: basis.reconstruct(np.ones((2, 10))), "c has .* each harmonic"),
    "infinite": (lambda basis: basis.reconstruct([np.inf] * 10), "c is not .* harmonic 0"),
    "one gain": (lambda basis: basis.filter(np.ones(602), lambda omega: [1]), "9 frequencies"),
    "no gain": (lambda basis: basis.filter(np.ones(602), lambda omega: np.log(-1 / omega)), "nan"),
    "negative time": (lambda basis: basis.heat_kernel_signature([1, -1]), "times = .1, -1."),
    "one time": (lambda basis: basis.heat_kernel_signature(1.0), "pass a list"),
    "no time": (lambda basis: basis.heat_kernel_signature([]), "pass a list"),
    "no energy": (lambda basis: basis.wave_kernel_signature(0), "count = 0"),
    "half an energy": (lambda basis: basis.wave_kernel_signature(2.5), "count = 2.5"),  # type: ignore[arg-type]
}


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
@pytest.mark.parametrize("case", REFUSED)
def test_a_wrong_argument_is_named(case: str, decimated: Decimated) -> None:
    call, named = REFUSED[case]
    basis = manifold_harmonics(*decimated("cow.obj"), 10)
    with pytest.raises(ValueError, match=named):
        call(basis)


def test_a_basis_of_constants_has_neither_times_nor_energies(decimated: Decimated) -> None:
    basis = manifold_harmonics(*decimated("cow.obj", 1000), 10)
    basis = Harmonics(basis.eigenvalues[:1], basis.harmonics[:, :1], basis.masses)
    with pytest.raises(ValueError, match="constant: compute more, or pass times"):
        basis.heat_kernel_signature()
    flat = basis.heat_kernel_signature([1.0])
    np.testing.assert_allclose(flat, 1 / basis.masses.sum(), rtol=1e-9)
    with pytest.raises(ValueError, match="the basis has 0: compute more harmonics"):
        basis.wave_kernel_signature()


@pytest.mark.parametrize("count", [0, 1, 2.5, True, "ten"])
def test_an_invalid_count_of_eigenvalues_is_refused(count: Any) -> None:
    with pytest.raises(OptionError, match=r"count = .* from 2 to"):
        shape_dna([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], count)


def test_more_eigenvalues_than_there_are_are_refused() -> None:
    with pytest.raises(FilterError, match=r"^count = 50 "):
        shape_dna([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
