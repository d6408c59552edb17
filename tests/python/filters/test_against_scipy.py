"""The plugin computes what an independent implementation with all eigenvectors computes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import spectral_reference as reference
from helpers import diagonal, filter_arrays, largest_distance, lower_part, percent
from numpy.typing import NDArray
from scipy.special import betainc
from shared_types import Decimated, Record
from transfer_functions import RESPONSES, TYPES, gain_of

Array = NDArray[Any]

AGREEMENT = 1e-6  # of the diagonal of the bounding box
FACES = 800  # the time of the reference is cubic
BASIS_SIZE = 100
INTRINSIC = {"laplacian": "intrinsic delaunay"}
# With 15 % and a full update the legs of the cow collapse into slivers of 1e-8 of the mean area,
# and noise of 1e-10 in the input grows 10,000 times: no two programs agree there.
SMALL = {"feature_size": percent(10)}
FULL, CONFORMAL = {"basis_update": "full"}, {"basis_update": "conformal"}


def assert_agrees(V: Array, Y: Array, expected: Array, record: Record) -> None:
    error = largest_distance(Y, expected) / diagonal(V)
    record("largest_distance_in_diagonals", error)
    assert largest_distance(expected, V) > 1e-3 * diagonal(V), "a test that moves nothing"
    assert error < AGREEMENT


def assert_full_spectrum_agrees(
    mesh: tuple[NDArray[Any], NDArray[Any]], options: dict[str, Any], record: Record
) -> None:
    V, F = mesh
    options = {"feature_size": percent(15), "laplacian": "cotangent", **options}
    Y, report = filter_arrays(V, F, **options)
    expected = reference.full_filter(
        V,
        F,
        gain_of(options, report),
        options["steps"],
        options.get("basis_update", "none"),
        options["laplacian"],
        options.get("conformal_share", 0.0),
    )
    assert_agrees(V, Y, expected, record)


# Options that are not those of `assert_full_spectrum_agrees`.
ON_THE_COW: dict[str, dict[str, Any]] = {
    f"{kind}, {response}": {**TYPES[kind], **RESPONSES[response], "steps": 1}
    for kind in TYPES
    for response in RESPONSES
} | {
    # A share that is exact in a 32-bit float.
    "a conformal share": {**SMALL, **INTRINSIC, "steps": 4, **FULL, "conformal_share": 0.25},
    "no update": {"steps": 8, "basis_update": "none"},
}
ON_EVERY_SAMPLE: dict[str, dict[str, Any]] = {
    "low-pass": {"steps": 1},
    "enhancement": {**TYPES["enhancement"], "steps": 1},
    "ideal": {"response": "ideal", "steps": 1},
    "eight steps, low-pass": {**SMALL, "steps": 8, **FULL},
    "eight steps, enhancement": {**TYPES["enhancement"], **SMALL, "steps": 8, **CONFORMAL},
    # As robust_laplacian has it.
    "intrinsic": {**SMALL, **INTRINSIC, "steps": 1, "basis_update": "none"},
    "intrinsic, full": {**SMALL, **INTRINSIC, "steps": 8, **FULL},
    "intrinsic, conformal": {**SMALL, **INTRINSIC, "steps": 8, **CONFORMAL},
}


@pytest.mark.parametrize("kind", ON_THE_COW)
def test_the_full_spectrum_agrees(kind: str, decimated: Decimated, record_property: Record) -> None:
    assert_full_spectrum_agrees(decimated("cow.obj", FACES), ON_THE_COW[kind], record_property)


@pytest.mark.parametrize("kind", ON_EVERY_SAMPLE)
def test_the_full_spectrum_agrees_on_every_sample(
    kind: str, sample_name: str, decimated: Decimated, record_property: Record
) -> None:
    mesh = decimated(sample_name, FACES)
    assert_full_spectrum_agrees(mesh, ON_EVERY_SAMPLE[kind], record_property)


@pytest.mark.parametrize("basis_update", ["conformal", "full"])
def test_the_uniform_laplacian_agrees(
    basis_update: str, decimated: Decimated, record_property: Record
) -> None:
    options = {"feature_size": percent(8), "laplacian": "uniform", "steps": 4}
    # The bunny has a boundary.
    mesh = decimated("bunny.obj", FACES)
    assert_full_spectrum_agrees(mesh, {**options, "basis_update": basis_update}, record_property)


@pytest.mark.parametrize("basis_update", ["full", "conformal"])
def test_a_custom_expression_agrees(
    basis_update: str, decimated: Decimated, record_property: Record
) -> None:
    V, F = decimated("cow.obj", FACES)
    options = {
        "filter_type": "custom",
        "transfer_function": "0.2 + 1.5*w/(1 + w^3)",
        "feature_size": percent(15),
        "laplacian": "cotangent",
        "steps": 3,
        "basis_update": basis_update,
    }
    Y, report = filter_arrays(V, F, **options)
    cutoff = 2 * np.pi / report["feature_size"]

    def gain(omega: NDArray[Any]) -> NDArray[Any]:
        w = omega / cutoff
        return 0.2 + 1.5 * w / (1 + w**3)

    expected = reference.full_filter(V, F, gain, 3, basis_update, "cotangent")
    assert_agrees(V, Y, expected, record_property)


def test_an_equalizer_agrees(decimated: Decimated, record_property: Record) -> None:
    V, F = decimated("cow.obj", FACES)
    options = {
        "filter_type": "custom",
        "transfer_function": "40%:1, 20%:1.5, 10%:0.8, 5%:0.2",
        "laplacian": "cotangent",
        "steps": 2,
        "basis_update": "conformal",
    }
    Y, report = filter_arrays(V, F, **options)
    # In log-log coordinates, from the tangent at one point to that at the next; the slopes are
    # those of the lesser secants.
    octaves = -np.log2(diagonal(V) * np.array([0.4, 0.2, 0.1, 0.05]))
    levels = np.log2([1, 1.5, 0.8, 0.2])
    secants = np.diff(levels) / np.diff(octaves)
    slopes = np.array([0, 0, max(secants[1], secants[2]), 0])

    def gain(omega: NDArray[Any]) -> NDArray[Any]:
        octave = np.clip(np.log2(np.maximum(omega, 1e-9) / (2 * np.pi)), octaves[0], octaves[-1])
        i = np.clip(np.searchsorted(octaves, octave) - 1, 0, 2)
        tangents = [levels[k] + (octave - octaves[k]) * slopes[k] for k in (i, i + 1)]
        blend = betainc(4, 4, (octave - octaves[i]) / (octaves[i + 1] - octaves[i]))
        return np.asarray(2 ** (tangents[0] + blend * (tangents[1] - tangents[0])))

    assert report["feature_size"] == pytest.approx(diagonal(V) * np.sqrt(0.4 * 0.05))
    expected = reference.full_filter(V, F, gain, 2, "conformal", "cotangent")
    assert_agrees(V, Y, expected, record_property)


@pytest.mark.parametrize("basis_update", ["full", "conformal"])
@pytest.mark.parametrize("filter_type", ["low-pass", "enhancement"])
def test_a_part_of_a_filter_agrees(
    filter_type: str, basis_update: str, decimated: Decimated, record_property: Record
) -> None:
    V, F = decimated("cow.obj", FACES)
    options = {
        **TYPES[filter_type],
        "feature_size": percent(15),
        "laplacian": "cotangent",
        "steps": 3,
        "basis_update": basis_update,
        "power": 0.25,
    }
    Y, report = filter_arrays(V, F, **options)
    whole = gain_of(options, report)
    expected = reference.full_filter(V, F, lambda omega: whole(omega) ** 0.25, 3, basis_update)
    assert_agrees(V, Y, expected, record_property)


@pytest.mark.parametrize("reinject_residual", [True, False], ids=["residual", "no residual"])
@pytest.mark.parametrize(
    ("steps", "basis_update"), [(1, "none"), (8, "conformal"), (8, "full")], ids=str
)
@pytest.mark.parametrize("filter_type", ["low-pass", "enhancement"])
def test_truncated_basis_agrees(
    filter_type: str,
    steps: int,
    basis_update: str,
    reinject_residual: bool,
    decimated: Decimated,
    record_property: Record,
) -> None:
    V, F = decimated("bunny.obj", 1600)
    options = {
        **TYPES[filter_type],
        "feature_size": percent(15),
        "laplacian": "cotangent",
        "spectrum": "truncated",
        "basis_size": 2 * BASIS_SIZE,
        "reinject_residual": reinject_residual,
        "steps": steps,
        "basis_update": basis_update,
    }
    Y, report = filter_arrays(V, F, **options)
    expected, sizes = reference.truncated_filter(
        V,
        F,
        gain_of(options, report),
        steps,
        basis_update,
        options["basis_size"],
        reinject_residual,
    )
    assert len(report["eigenvalues"]) == sizes[report["computed_bases"] - 1]
    assert_agrees(V, Y, expected, record_property)


def test_eigenvalues_of_a_truncated_basis_agree(sample_name: str, decimated: Decimated) -> None:
    V, F = decimated(sample_name, FACES)
    _, report = filter_arrays(
        V, F, spectrum="truncated", basis_size=100, steps=1, laplacian="cotangent"
    )
    found = report["eigenvalues"]
    (spectrum,) = reference.spectra(
        reference.cotangent_matrix(V, F),
        reference.lumped_areas(V, F),
        reference.components(len(V), F),
    )
    expected = spectrum.lam[: len(found)]
    assert len(found) >= 100
    assert found[0] == 0
    assert abs(found[1:] / expected[1:] - 1).max() < 1e-8


@pytest.mark.parametrize("filter_type", ["low-pass", "enhancement"])
@pytest.mark.parametrize(
    ("steps", "basis_update"), [(1, "none"), (6, "conformal"), (6, "full")], ids=str
)
@pytest.mark.parametrize("spectrum", ["full", "truncated"])
@pytest.mark.parametrize("laplacian", ["cotangent", "intrinsic delaunay"])
def test_a_fixed_boundary_agrees(
    laplacian: str,
    spectrum: str,
    steps: int,
    basis_update: str,
    filter_type: str,
    decimated: Decimated,
    record_property: Record,
) -> None:
    V, F = lower_part(*decimated("bunny.obj", FACES))
    options = {
        **TYPES[filter_type],
        "feature_size": percent(10),
        "laplacian": laplacian,
        "boundary": "fixed",
        "spectrum": spectrum,
        "basis_size": BASIS_SIZE,
        "steps": steps,
        "basis_update": basis_update,
    }
    Y, report = filter_arrays(V, F, **options)
    expected = reference.fixed_filter(
        V,
        F,
        gain_of(options, report),
        steps,
        basis_update,
        laplacian,
        BASIS_SIZE if spectrum == "truncated" else None,
    )
    assert_agrees(V, Y, expected, record_property)
    rim = reference.boundary_vertices(F)
    assert report["fixed_vertices"] == len(rim) > 15
    np.testing.assert_array_equal(Y[rim], V[rim])
