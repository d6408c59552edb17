"""Harmonics for scripts, the command `meshlab-spectral basis`: arrays, pictures, messages."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import commands
import matplotlib.image
import numpy as np
import pytest
import spectral_reference as reference
from commands import messages_in
from helpers import diagonal, lower_part, mesh_set_of
from meshlab_spectral import FilterError, Harmonics, OptionError, manifold_harmonics
from meshlab_spectral.figures.harmonics import spread_modes
from numpy.typing import NDArray
from shared_types import Decimated

PRECIOUS = b"precious bytes of a file that was here before\n"
TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    return commands.command("basis", *arguments)


@pytest.fixture
def half_bunny(decimated: Decimated, tmp_path: Path) -> Path:
    path = tmp_path / "half_bunny.ply"
    mesh_set_of(*lower_part(*decimated("bunny.obj", 1200))).save_current_mesh(str(path))
    return path


def spectrum_of(V: NDArray[Any], F: NDArray[Any], boundary: str) -> reference.Spectrum:
    W, d = reference.matrices(V, F, "intrinsic delaunay")
    if boundary == "fixed":
        interior = np.setdiff1d(np.arange(len(V)), reference.boundary_vertices(F))
        return reference.fixed_spectrum(W, d, interior)
    (spectrum,) = reference.spectra(W, d, [np.arange(len(V))])
    return spectrum


@pytest.mark.parametrize("boundary", ["free", "fixed"])
def test_the_archive_holds_what_scipy_computes(
    boundary: str, half_bunny: Path, tmp_path: Path
) -> None:
    output = tmp_path / "basis.npz"
    done = command(half_bunny, "-k", 30, "--boundary", boundary, "--output", output)
    assert done.returncode == 0, done.stderr
    assert messages_in(done.stderr) == ""
    assert done.stdout == f"{output}\n"
    assert {path.name for path in tmp_path.iterdir()} == {"basis.npz", "half_bunny.ply"}
    with np.load(output) as archive:
        arrays = dict(archive)
    V, F, Phi, d = (arrays[name] for name in ("vertices", "faces", "harmonics", "masses"))
    assert Phi.shape == (len(V), 30)
    assert Phi.dtype == np.float64
    np.testing.assert_allclose(d, reference.lumped_areas(V, F), rtol=1e-12)
    np.testing.assert_allclose(Phi.T @ (d[:, None] * Phi), np.eye(30), rtol=0, atol=1e-9)
    expected = spectrum_of(V, F, boundary)
    lam = expected.lam[:30]
    np.testing.assert_allclose(arrays["eigenvalues"], lam, rtol=0, atol=1e-8 * lam[-1])
    np.testing.assert_array_equal(arrays["frequencies"], np.sqrt(arrays["eigenvalues"]))
    overlap = expected.Phi.T[:30] @ (expected.d[:, None] * Phi[expected.of])
    assert np.linalg.norm(overlap[:, :20], axis=0).min() > 1 - 1e-6
    assert (arrays["eigenvalues"][0] == 0) == (boundary == "free")


def test_the_function_gives_the_same_as_the_command(half_bunny: Path, tmp_path: Path) -> None:
    output = tmp_path / "basis.npz"
    assert command(half_bunny, "-k", 20, "--output", output).returncode == 0
    with np.load(output) as archive:
        found = manifold_harmonics(archive["vertices"], archive["faces"], 20)
        assert isinstance(found, Harmonics)
        for name in ("eigenvalues", "frequencies", "harmonics", "masses"):
            np.testing.assert_array_equal(getattr(found, name), archive[name], err_msg=name)


def test_the_cotangent_laplacian_and_lists_are_accepted(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    W, d = reference.matrices(V, F, "cotangent")
    (expected,) = reference.spectra(W, d, [np.arange(len(V))])
    found = manifold_harmonics(V.tolist(), F.tolist(), 15, laplacian="cotangent", boundary="fixed")
    np.testing.assert_allclose(found.eigenvalues, expected.lam[:15], rtol=0, atol=1e-6)


def test_the_chosen_pictures_are_drawn(half_bunny: Path, tmp_path: Path) -> None:
    output, sheet = tmp_path / "basis.npz", tmp_path / "sheet.png"
    arguments = ["-k", 20, "--output", output, "--pictures", sheet, "--scale", 0.3]
    done = command(half_bunny, *arguments, "--modes", "0,7,19")
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{output}\n{sheet}\n"
    few = matplotlib.image.imread(sheet)
    assert 0.1 < (few[:, :, :3] < 0.98).any(axis=2).mean() < 0.9
    assert command(half_bunny, *arguments, "--overwrite").returncode == 0
    dozen = matplotlib.image.imread(sheet)
    assert dozen.shape[0] > 1.5 * few.shape[0], "more rows"


@pytest.mark.parametrize(("first", "size"), [(1, 100), (0, 40), (1, 13), (3, 300), (2, 5), (0, 1)])
def test_a_dozen_pictures_range_from_the_first_harmonic_to_the_last(first: int, size: int) -> None:
    modes = spread_modes(first, size)
    assert modes[0] == first
    assert modes == sorted(set(modes))
    assert len(modes) == min(12, size - first)
    assert modes[-1] == size - 1


def test_an_archive_is_replaced_on_request_only(half_bunny: Path, tmp_path: Path) -> None:
    output = tmp_path / "basis.npz"
    output.write_bytes(PRECIOUS)
    arguments = (half_bunny, "--output", output, "--basis-size", 5)
    done = command(*arguments)
    assert done.returncode == 2
    assert "basis.npz exists" in done.stderr
    assert output.read_bytes() == PRECIOUS
    assert command(*arguments, "--overwrite").returncode == 0
    assert output.read_bytes() != PRECIOUS


def test_a_missing_mesh_and_one_without_faces_are_named(
    decimated: Decimated, tmp_path: Path
) -> None:
    output = tmp_path / "basis.npz"
    done = command(tmp_path / "none.ply", "--output", output)
    assert done.returncode == 1
    assert "none.ply" in done.stderr
    points = tmp_path / "points.ply"
    mesh_set_of(decimated("cow.obj", 1000)[0], np.zeros((0, 3), dtype=int)).save_current_mesh(
        str(points)
    )
    done = command(points, "--output", output)
    assert done.returncode == 1
    assert "no faces" in done.stderr
    assert not output.exists()


def test_invalid_arrays_and_options_are_refused() -> None:
    V, F = TRIANGLE
    with pytest.raises(ValueError, match="vertex 3"):
        manifold_harmonics(V, F + 1)
    with pytest.raises(OptionError, match="free, fixed"):
        manifold_harmonics(V, F, 2, boundary="loose")  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="intrinsic delaunay, cotangent"):
        manifold_harmonics(V, F, 2, laplacian="graph")  # type: ignore[arg-type]
    with pytest.raises(FilterError, match="at most 2"):
        manifold_harmonics(V, F, 3)
    with pytest.raises(FilterError, match="boundary = free"):
        manifold_harmonics(V, F, 1, boundary="fixed")


def test_frequencies_and_masses_scale_with_the_mesh(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    one, ten = manifold_harmonics(V, F, 10), manifold_harmonics(10 * V, F, 10)
    np.testing.assert_allclose(10 * ten.frequencies, one.frequencies, rtol=1e-7)
    np.testing.assert_allclose(ten.masses, 100 * one.masses, rtol=1e-9)
    assert 2 * np.pi / ten.frequencies[1] > diagonal(V)
