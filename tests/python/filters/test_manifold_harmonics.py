"""The filter "Manifold Harmonics" agrees with SciPy's eigensolver, with definite signs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
import scipy.sparse
import scipy.sparse.linalg
import spectral_reference as reference
from helpers import assert_same, lower_part, mesh_set_of, snapshot
from meshlab_spectral import OptionError, manifold_harmonics
from meshlab_spectral.files.meshes import load_arrays
from numpy.typing import NDArray
from shared_types import Decimated

HARMONICS = "compute_scalar_manifold_harmonic_per_vertex"


def eigenpairs(
    V: NDArray[Any], F: NDArray[Any], k: int, laplacian: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the k lowest eigenpairs of W phi = lambda D phi by ARPACK."""
    W, d = reference.matrices(V, F, laplacian)
    lam, Phi = scipy.sparse.linalg.eigsh(
        scipy.sparse.csc_array(W), k, scipy.sparse.diags_array(d, format="csc"), sigma=-1.0
    )
    return lam, Phi


def stored_basis(mesh: pymeshlab.Mesh, k: int) -> NDArray[np.float64]:
    """Read the n x k basis from the mesh's attributes."""
    return np.column_stack(
        [mesh.vertex_custom_scalar_attribute_array(f"harmonic_{i}") for i in range(k)]
    )


def has_attribute(mesh: pymeshlab.Mesh, name: str) -> bool:
    try:
        mesh.vertex_custom_scalar_attribute_array(name)
    except pymeshlab.PyMeshLabException:
        return False
    return True


def test_eigenvalues_and_harmonics_agree_with_scipy(sample_name: str, decimated: Decimated) -> None:
    V, F = decimated(sample_name)
    mesh_set = mesh_set_of(V, F)
    report = mesh_set.apply_filter(HARMONICS, mode=5, basis_size=30, store_basis=True)
    lam, Phi = eigenpairs(V, F, 30, "intrinsic delaunay")
    assert report.keys() == {"eigenvalues", "residuals", "inertia_count", "whole_size"}
    assert len(report["eigenvalues"]) == len(report["residuals"]) == 30
    assert (report["residuals"] < 1e-8).all()
    assert report["inertia_count"] >= 30
    assert report["eigenvalues"][0] == 0
    np.testing.assert_allclose(report["eigenvalues"], lam, rtol=0, atol=1e-8 * lam[-1])

    basis = stored_basis(mesh_set.current_mesh(), 30)
    d = reference.lumped_areas(V, F)
    np.testing.assert_allclose(basis.T @ (d[:, None] * basis), np.eye(30), rtol=0, atol=1e-9)
    gaps = np.diff(lam).min() / lam[-1]
    assert gaps > 1e-5, "equal eigenvalues: their vectors cannot be compared one by one"
    overlap = np.abs(np.sum(Phi * d[:, None] * basis, axis=0))
    np.testing.assert_allclose(overlap, 1, rtol=0, atol=1e-7)
    assert (basis.max(axis=0) > (1 - 1e-6) * np.abs(basis).max(axis=0)).all(), "of definite signs"


@pytest.mark.parametrize("laplacian", ["cotangent", "intrinsic delaunay"])
def test_on_a_fixed_boundary_harmonics_vanish_and_agree_with_scipy(
    sample_name: str, laplacian: str, decimated: Decimated
) -> None:
    V, F = lower_part(*decimated(sample_name))
    mesh_set = mesh_set_of(V, F)
    report = mesh_set.apply_filter(
        HARMONICS, basis_size=20, laplacian=laplacian, boundary="fixed", store_basis=True
    )
    rim = reference.boundary_vertices(F)
    W, d = reference.matrices(V, F, laplacian)
    spectrum = reference.fixed_spectrum(W, d, np.setdiff1d(np.arange(len(V)), rim))
    lam = spectrum.lam[:20]
    np.testing.assert_allclose(report["eigenvalues"], lam, rtol=0, atol=1e-8 * lam[-1])
    basis = stored_basis(mesh_set.current_mesh(), 20)
    assert (basis[rim] == 0).all()
    # Whole spaces of harmonics, since eigenvalues may be nearly equal.
    overlap = spectrum.Phi.T[:20] @ (spectrum.d[:, None] * basis[spectrum.of])
    assert np.linalg.norm(overlap[:, :10], axis=0).min() > 1 - 1e-6


@pytest.mark.parametrize("laplacian", ["uniform", "cotangent", "intrinsic delaunay"])
def test_harmonics_are_orthonormal_with_the_returned_masses(
    laplacian: Any, decimated: Decimated, cow: Path
) -> None:
    V, F = decimated("cow.obj")
    unreferenced = np.vstack([V, [[0, 0, 9]]]), F
    cut = V[F.ravel()], np.arange(F.size).reshape(-1, 3)  # seams along all edges
    touching = load_arrays(cow)  # at a point, which two vertices share without a seam
    assert len(np.unique(touching[0], axis=0)) == len(touching[0]) - 1
    for vertices, faces in ((V, F), unreferenced, cut, touching):
        basis = manifold_harmonics(vertices, faces, 20, laplacian)
        gram = basis.harmonics.T @ (basis.masses[:, None] * basis.harmonics)
        np.testing.assert_allclose(gram, np.eye(20), rtol=0, atol=1e-8)
        area = reference.lumped_areas(vertices, faces).sum()
        assert basis.masses.sum() == pytest.approx(area)


def test_the_mode_is_the_quality_with_its_extreme_value_positive(decimated: Decimated) -> None:
    V, F = decimated("cow.obj")
    mesh_set = mesh_set_of(V, F)
    before = snapshot(mesh_set.current_mesh())
    mesh_set.apply_filter(HARMONICS, mode=7, basis_size=20, store_basis=True)
    mesh = mesh_set.current_mesh()
    quality = mesh.vertex_scalar_array()
    np.testing.assert_array_equal(quality, stored_basis(mesh, 20)[:, 7])
    assert quality.max() > -quality.min() > 0

    colours = mesh.vertex_color_matrix()
    np.testing.assert_array_equal(colours[quality.argmax()], [1, 0, 0, 1])
    assert (colours[quality > 0, 0] == 1).all(), "red has its full share where positive"
    assert (colours[quality < 0, 2] == 1).all(), "blue has its full share where negative"
    faded = 1 - np.abs(quality) / quality.max()
    np.testing.assert_allclose(colours[:, 1], faded, rtol=0, atol=0.5 / 255 + 1e-6)

    after = snapshot(mesh)
    for name in ("vertex_scalar_array", "vertex_color_matrix"):
        before.pop(name, None)
        del after[name]
    assert_same(before, after)


def test_signs_do_not_depend_on_the_order_of_the_vertices(
    sample_name: str, decimated: Decimated
) -> None:
    V, F = decimated(sample_name)
    order = np.random.default_rng(3).permutation(len(V))
    place = np.argsort(order)
    bases = []
    for mesh_set in (mesh_set_of(V, F), mesh_set_of(V[order], place[F])):
        mesh_set.apply_filter(HARMONICS, basis_size=30, store_basis=True)
        bases.append(stored_basis(mesh_set.current_mesh(), 30))
    scale = np.abs(bases[0]).max()
    np.testing.assert_allclose(bases[1], bases[0][order], rtol=0, atol=1e-5 * scale)


def test_every_component_has_a_constant_first(decimated: Decimated) -> None:
    V, F = decimated("cow.obj", 1000)
    two = np.vstack([V, V + 10]), np.vstack([F, F + len(V)])
    mesh_set = mesh_set_of(*two)
    report = mesh_set.apply_filter(HARMONICS, mode=1, basis_size=10)
    np.testing.assert_array_equal(report["eigenvalues"][:2], 0)
    assert report["eigenvalues"][2] > 0
    quality = mesh_set.current_mesh().vertex_scalar_array()
    assert quality.min() == 0
    assert len(np.unique(quality)) == 2


def test_after_a_deletion_harmonics_are_at_the_remaining_vertices(
    decimated: Decimated, tmp_path: Path
) -> None:
    V, F = decimated("cow.obj")
    script = mesh_set_of(V, F)
    script.compute_selection_by_condition_per_vertex(condselect="(z > 0.4)")
    script.meshing_remove_selected_vertices()
    clean = mesh_set_of(script.current_mesh().vertex_matrix(), script.current_mesh().face_matrix())
    script.apply_filter(HARMONICS, mode=2, basis_size=10, store_basis=True)
    script.save_filter_script(str(tmp_path / "script.mlx"))
    clean.apply_filter(HARMONICS, mode=2, basis_size=10, store_basis=True)
    expected = stored_basis(clean.current_mesh(), 10)

    # As one script, so that pymeshlab touches nothing in between.
    replay = mesh_set_of(V, F)
    replay.load_filter_script(str(tmp_path / "script.mlx"))
    replay.apply_filter_script()
    for mesh_set in (script, replay):
        mesh = mesh_set.current_mesh()
        np.testing.assert_allclose(stored_basis(mesh, 10), expected, rtol=0, atol=1e-9)
        np.testing.assert_allclose(mesh.vertex_scalar_array(), expected[:, 2], rtol=0, atol=1e-9)


def test_the_basis_is_stored_only_when_asked_for_and_replaces_an_older_one(
    decimated: Decimated,
) -> None:
    mesh_set = mesh_set_of(*decimated("cow.obj"))
    mesh = mesh_set.current_mesh()
    mesh_set.apply_filter(HARMONICS, basis_size=12)
    assert not has_attribute(mesh, "harmonic_0")
    mesh.add_vertex_custom_scalar_attribute(np.ones(mesh.vertex_number()), "age")
    mesh.add_vertex_custom_point_attribute(np.ones((mesh.vertex_number(), 3)), "harmonic_3")
    mesh_set.apply_filter(HARMONICS, basis_size=12, store_basis=True)
    assert has_attribute(mesh, "harmonic_11")
    mesh_set.apply_filter(HARMONICS, basis_size=8, store_basis=True)
    assert has_attribute(mesh, "harmonic_7")
    assert not any(has_attribute(mesh, f"harmonic_{number}") for number in range(8, 12))
    assert (mesh.vertex_custom_scalar_attribute_array("age") == 1).all()


@pytest.mark.parametrize("basis_size", [0, 2.5, True, "ten", 2**31])
def test_an_invalid_basis_size_is_refused(basis_size: Any) -> None:
    with pytest.raises(OptionError, match="basis_size"):
        manifold_harmonics([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], basis_size)


def test_the_defaults_of_a_mesh_set_suit_a_tiny_mesh() -> None:
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    mesh_set = mesh_set_of(V, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))
    report = mesh_set.apply_filter(HARMONICS)
    assert len(report["eigenvalues"]) == 3
