"""`mesh.spectral` on meshes of PyVista."""

from __future__ import annotations

import meshlab_spectral
import numpy as np
import pytest
from meshlab_spectral import OptionError

pyvista = pytest.importorskip("pyvista", minversion="0.48")


@pytest.fixture
def mesh() -> pyvista.PolyData:
    mesh = pyvista.Icosphere(radius=2.0, nsub=3)
    noise = np.random.default_rng(1).normal(size=mesh.n_points)
    mesh.points = mesh.points * (1 + 0.02 * noise[:, None])
    mesh["height"] = np.asarray(mesh.points[:, 2], dtype=float)
    return mesh


def test_methods_are_the_functions_and_can_be_chained(mesh: pyvista.PolyData) -> None:
    before = mesh.points.copy()
    done = mesh.spectral.denoise().spectral.filter(feature_size="20%")
    denoised, _ = meshlab_spectral.denoise_mesh(mesh)
    filtered, report = meshlab_spectral.filter_mesh(denoised, feature_size="20%")
    np.testing.assert_array_equal(done.points, filtered.points)
    np.testing.assert_array_equal(mesh.points, before)
    assert done.user_dict["spectral"]["max_displacement"] == report["max_displacement"]


def test_point_arrays_are_filtered_by_name(mesh: pyvista.PolyData) -> None:
    done = mesh.spectral.filter_scalars("height", feature_size="20%")
    values, _ = meshlab_spectral.filter_scalars(mesh, values="height", feature_size="20%")
    np.testing.assert_array_equal(done["height"], values)
    assert not np.array_equal(mesh["height"], values)
    with pytest.raises(ValueError, match="has no such array"):
        mesh.spectral.filter_scalars("depth")


def test_measures_are_those_of_the_functions(mesh: pyvista.PolyData) -> None:
    eigenvalues = meshlab_spectral.manifold_harmonics(mesh, 9).eigenvalues
    np.testing.assert_array_equal(mesh.spectral.harmonics(9).eigenvalues, eigenvalues)
    energies = meshlab_spectral.geometry_spectrum(mesh).octave_energies
    np.testing.assert_array_equal(mesh.spectral.spectrum().octave_energies, energies)


def test_errors_are_those_of_the_functions(mesh: pyvista.PolyData) -> None:
    with pytest.raises(OptionError, match="feature_size"):
        mesh.spectral.filter(feature_size="-1%")


def test_in_place_changes_the_mesh_itself_as_pyvistas_filters_do(mesh: pyvista.PolyData) -> None:
    filtered = mesh.spectral.filter(feature_size="20%")
    same = mesh.spectral.filter(feature_size="20%", inplace=True)
    assert same is mesh
    np.testing.assert_array_equal(mesh.points, filtered.points)
    assert mesh.user_dict["spectral"] == filtered.user_dict["spectral"]
