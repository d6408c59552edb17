"""Calls as users of other projects would write them, after the documentation of these.

A call works, or is refused with the remedy. Those of LaPy, pyFM, libigl and Open3D run where these
are installed: pip install lapy pyfmaps libigl open3d.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import meshlab_spectral
import numpy as np
import pymeshlab
import pytest
import pyvista as pv
import trimesh
from commands import COMMAND, command, succeeded
from meshlab_spectral import denoise_mesh, filter_mesh, laplacian

Calls = dict[str, Callable[[Path], Any]]


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    """A noisy sphere."""
    ball = pv.Icosphere(nsub=3)
    noise = np.random.default_rng(5).standard_normal(ball.n_points)
    ball.points *= (1 + 0.02 * noise)[:, None]
    path = tmp_path / "scan.ply"
    trimesh.Trimesh(ball.points, ball.regular_faces, process=False).export(path)
    return path


def expected(scan: Path) -> Any:
    """What the filter of coordinates makes of the scan."""
    mesh = trimesh.load_mesh(scan, process=False)
    return filter_mesh(np.asarray(mesh.vertices), np.asarray(mesh.faces), feature_size="5%")[0]


def assert_filtered(V: Any, scan: Path, error: float = 1e-6) -> None:
    np.testing.assert_allclose(np.asarray(V), expected(scan), atol=error)


def refused(call: Callable[[], object], *remedies: str) -> None:
    """The call raises an error with these words."""
    errors = (ValueError, TypeError, meshlab_spectral.SpectralError, pymeshlab.PyMeshLabException)
    with pytest.raises(errors) as caught:
        call()
    for remedy in remedies:
        assert remedy in str(caught.value)


def shell(*arguments: object, mesh: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    words = [*COMMAND, *map(str, arguments)]
    return subprocess.run(words, input=mesh, capture_output=True, timeout=120, check=False)


def shown(*arguments: object) -> str:
    """What a command that succeeds prints."""
    done = succeeded(*arguments)
    return done.stdout


def shell_refused(*arguments: object, remedy: str) -> None:
    done = command(*arguments)
    assert done.returncode in (1, 2), done.stderr
    assert remedy in done.stderr


# pymeshlab -----------------------------------------------------------------------------------


def mesh_set(scan: Path) -> Any:
    meshlab_spectral.load()
    ms = pymeshlab.MeshSet(verbose=False)
    ms.load_new_mesh(str(scan))
    return ms


def by_the_method(scan: Path) -> None:
    ms = mesh_set(scan)
    report = ms.apply_coord_spectral_filter_fractional(feature_size=pymeshlab.PercentageValue(5))
    assert report["max_displacement"] > 0
    assert_filtered(ms.current_mesh().vertex_matrix(), scan)


def by_apply_filter(scan: Path) -> None:
    ms = mesh_set(scan)
    ms.apply_filter(
        "apply_coord_spectral_filter_fractional", feature_size=pymeshlab.PercentageValue(5)
    )
    assert_filtered(ms.current_mesh().vertex_matrix(), scan)


def on_the_selection(scan: Path) -> None:
    ms = mesh_set(scan)
    ms.compute_selection_by_condition_per_vertex(condselect="z > 0.5")
    before = ms.current_mesh().vertex_matrix().copy()
    ms.apply_coord_spectral_filter_fractional(selected=True)
    moved = (ms.current_mesh().vertex_matrix() != before).any(axis=1)
    assert 0 < moved.sum() < 0.7 * len(before)


def with_a_mesh_of_a_mesh_set(scan: Path) -> None:
    ms = mesh_set(scan)
    moved, _ = filter_mesh(ms.current_mesh(), feature_size="5%")
    assert_filtered(moved.vertex_matrix(), scan)


def with_pymeshlabs_percentage(scan: Path) -> None:
    ms = mesh_set(scan)
    mesh = ms.current_mesh()
    V, F = mesh.vertex_matrix(), mesh.face_matrix()
    moved, _ = filter_mesh(V, F, feature_size=pymeshlab.PercentageValue(5))
    assert_filtered(moved, scan)


def a_list_of_parameters(scan: Path) -> None:
    meshlab_spectral.load()
    pymeshlab.print_filter_parameter_list("apply_coord_spectral_denoise")


def with_a_mesh_set(scan: Path) -> None:
    refused(lambda: filter_mesh(mesh_set(scan)), "current_mesh()")


def with_an_option_of_taubins(scan: Path) -> None:
    ms = mesh_set(scan)
    refused(lambda: ms.apply_coord_spectral_filter_fractional(stepsmoothnum=10), "feature_size")


# pyvista -------------------------------------------------------------------------------------


def by_the_accessor(scan: Path) -> None:
    done = pv.read(scan).spectral.denoise().spectral.filter(feature_size="5%")
    assert isinstance(done, pv.PolyData)


def with_a_length(scan: Path) -> None:
    mesh = pv.read(scan)
    assert_filtered(mesh.spectral.filter(feature_size=0.05 * mesh.length).points, scan)


def in_place(scan: Path) -> None:
    mesh = pv.read(scan)
    mesh.spectral.filter(feature_size="5%", inplace=True)
    assert_filtered(mesh.points, scan)


def with_a_progress_bar(scan: Path) -> None:
    assert pv.read(scan).spectral.denoise(progress_bar=True).n_points


def on_the_result_of_a_filter_of_cells(scan: Path) -> None:
    mesh = pv.read(scan)
    mesh["height"] = mesh.points[:, 2]
    upper = mesh.threshold(0.0, scalars="height")  # an UnstructuredGrid
    assert upper.spectral.filter(feature_size="5%").n_points == upper.n_points


def with_quadrangles(scan: Path) -> None:
    refused(pv.Plane().spectral.denoise, "triangulate()")


def an_array_by_name(scan: Path) -> None:
    mesh = pv.read(scan)
    mesh["height"] = mesh.points[:, 2].astype(float)
    assert "height" in mesh.spectral.filter_scalars("height", feature_size="20%").point_data


def harmonics_to_look_at(scan: Path) -> None:
    mesh = pv.read(scan)
    mesh["phi"] = mesh.spectral.harmonics(20).harmonics[:, 5]
    assert mesh["phi"].std() > 0


# trimesh -------------------------------------------------------------------------------------


def a_trimesh(scan: Path) -> None:
    moved, _ = filter_mesh(trimesh.load_mesh(scan, process=False), feature_size="5%")
    assert isinstance(moved, trimesh.Trimesh)
    assert_filtered(moved.vertices, scan)


def tracked_arrays(scan: Path) -> None:
    mesh = trimesh.load_mesh(scan, process=False)
    assert_filtered(filter_mesh(mesh.vertices, mesh.faces, feature_size="5%")[0], scan)


def of_meshio(scan: Path) -> None:
    moved, _ = filter_mesh(meshio.read(scan), feature_size="5%")
    assert_filtered(moved.points, scan)
    moved.write(scan.with_name("out.vtk"))


def signatures(scan: Path) -> None:
    basis = meshlab_spectral.manifold_harmonics(trimesh.load_mesh(scan), 20)
    assert basis.heat_kernel_signature().shape == (len(basis.masses), 16)


def with_iterations(scan: Path) -> None:
    mesh = trimesh.load_mesh(scan)
    refused(lambda: filter_mesh(mesh, lamb=0.5, iterations=10), "feature_size")


def a_scene(scan: Path) -> None:
    refused(lambda: denoise_mesh(trimesh.Scene(trimesh.load_mesh(scan))), "to_mesh()")


def a_path(scan: Path) -> None:
    refused(lambda: denoise_mesh(str(scan)), "read the file first")


# libraries that are not in the test environment -----------------------------------------------


def lapys_mesh(scan: Path) -> None:
    lapy = pytest.importorskip("lapy")
    ball = trimesh.load_mesh(scan, process=False)
    tria = lapy.TriaMesh(ball.vertices, ball.faces)
    moved, _ = filter_mesh(tria, feature_size="5%")
    assert isinstance(moved, lapy.TriaMesh)
    assert_filtered(moved.v, scan)


def eigenpairs_as_a_pair(scan: Path) -> None:
    evals, evecs = meshlab_spectral.manifold_harmonics(trimesh.load_mesh(scan), 10)
    assert evals.shape == (10,)
    assert evecs.shape[1] == 10


def eigenpairs_with_k(scan: Path) -> None:
    mesh = trimesh.load_mesh(scan)
    refused(lambda: meshlab_spectral.manifold_harmonics(mesh, k=10), "basis_size")


def shape_dna_of_lapy(scan: Path) -> None:
    lapy = pytest.importorskip("lapy")
    from lapy.shapedna import compute_shapedna, normalize_ev

    ball = trimesh.load_mesh(scan, process=False)
    tria = lapy.TriaMesh(ball.vertices, ball.faces)
    theirs = normalize_ev(tria, compute_shapedna(tria, k=10, lump=True)["Eigenvalues"])
    ours = meshlab_spectral.shape_dna(tria, 10, laplacian="cotangent")
    np.testing.assert_allclose(ours, theirs, rtol=1e-3, atol=1e-3)


def pyfms_mesh(scan: Path) -> None:
    pyfm = pytest.importorskip("pyFM.mesh")
    ball = trimesh.load_mesh(scan, process=False)
    mesh = pyfm.TriMesh(np.asarray(ball.vertices), np.asarray(ball.faces))
    moved, _ = filter_mesh(mesh, feature_size="5%")
    assert type(moved) is type(mesh)
    assert_filtered(moved.vertices, scan)


def spectrum_of_pyfm(scan: Path) -> None:
    pyfm = pytest.importorskip("pyFM.mesh")
    ball = trimesh.load_mesh(scan, process=False)
    mesh = pyfm.TriMesh(np.asarray(ball.vertices), np.asarray(ball.faces))
    mesh.process(k=10)
    ours = meshlab_spectral.manifold_harmonics(mesh, 10, "cotangent").eigenvalues
    np.testing.assert_allclose(ours, mesh.eigenvalues[:10], rtol=1e-4, atol=1e-4)


def arrays_of_igl(scan: Path) -> None:
    igl = pytest.importorskip("igl")
    V, F = igl.read_triangle_mesh(str(scan))
    assert_filtered(filter_mesh(V, F, feature_size="5%")[0], scan)


def a_pair(scan: Path) -> None:
    mesh = trimesh.load_mesh(scan, process=False)
    (V, F), _ = filter_mesh((mesh.vertices, mesh.faces), feature_size="5%")
    assert_filtered(V, scan)
    assert F is mesh.faces or np.array_equal(F, mesh.faces)


def cotmatrix_of_igl(scan: Path) -> None:
    igl = pytest.importorskip("igl")
    V, F = igl.read_triangle_mesh(str(scan))
    W, D = laplacian(V, F, kind="cotangent")
    assert abs(W + igl.cotmatrix(V, F)).max() < 1e-9
    masses = igl.massmatrix(V, F, igl.MASSMATRIX_TYPE_BARYCENTRIC).diagonal()
    np.testing.assert_allclose(D, masses, rtol=1e-9)


def open3ds_mesh(scan: Path) -> None:
    o3d = pytest.importorskip("open3d")
    moved, _ = filter_mesh(o3d.io.read_triangle_mesh(str(scan)), feature_size="5%")
    assert isinstance(moved, o3d.geometry.TriangleMesh)
    assert_filtered(moved.vertices, scan)


def open3ds_tensor_mesh(scan: Path) -> None:
    o3d = pytest.importorskip("open3d")
    moved, _ = filter_mesh(o3d.t.io.read_triangle_mesh(str(scan)), feature_size="5%")
    assert_filtered(moved.vertex.positions.numpy(), scan)


def with_a_number_of_iterations(scan: Path) -> None:
    mesh = trimesh.load_mesh(scan)
    refused(lambda: filter_mesh(mesh, number_of_iterations=10), "feature_size")


# the shell ------------------------------------------------------------------------------------


def filter_with_o(scan: Path) -> None:
    out = scan.with_name("out.ply")
    shown("filter", scan, "-o", out, "--feature-size", "5%")
    assert_filtered(trimesh.load_mesh(out, process=False).vertices, scan)


def filter_in_a_pipe(scan: Path) -> None:
    done = shell("filter", "-", "-", "--format", "ply", mesh=scan.read_bytes())
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(b"ply")


def dry_run(scan: Path) -> None:
    assert "Nothing was written" in shown("denoise", scan, scan.with_name("out.ply"), "-n")
    assert [path.name for path in scan.parent.iterdir()] == [scan.name]


def help_of_a_command(scan: Path) -> None:
    assert "--feature-size" in shown("help", "filter")
    assert "denoise" in shown("help")
    assert shown("filter", "--help") == shown("help", "filter")
    assert "--feature-size" in shown("filter", "-h")


def info_for_a_program(scan: Path) -> None:
    assert json.loads(shown("info", scan, "--json"))["noise_kind"] == "white"


def a_part(scan: Path) -> None:
    shown("denoise", scan, scan.with_name("out.ply"), "--where", "z > 0.5", "--json")


def without_colours(scan: Path) -> None:
    done = command("info", scan, NO_COLOR="1", TERM="dumb")
    assert "\x1b" not in done.stdout + done.stderr


def as_a_module(scan: Path) -> None:
    words = [sys.executable, "-m", "meshlab_spectral", "--version"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout.startswith("meshlab-spectral "), done.stderr


def with_force(scan: Path) -> None:
    shown("filter", scan, scan.with_name("out.ply"))
    shown("filter", scan, scan.with_name("out.ply"), "--force")


def with_iterations_in_the_shell(scan: Path) -> None:
    shell_refused(
        "filter", scan, scan.with_name("out.ply"), "--iterations", 10, remedy="--feature-size"
    )


def several_files(scan: Path) -> None:
    shell_refused("denoise", scan, scan.with_name("b.ply"), scan.with_name("c.ply"), remedy="batch")


def a_misspelled_command(scan: Path) -> None:
    shell_refused("fliter", scan, remedy="filter")


WORKING = [
    by_the_method,
    by_apply_filter,
    on_the_selection,
    with_a_mesh_of_a_mesh_set,
    with_pymeshlabs_percentage,
    a_list_of_parameters,
    by_the_accessor,
    with_a_length,
    in_place,
    with_a_progress_bar,
    on_the_result_of_a_filter_of_cells,
    an_array_by_name,
    harmonics_to_look_at,
    a_trimesh,
    of_meshio,
    signatures,
    tracked_arrays,
    lapys_mesh,
    eigenpairs_as_a_pair,
    shape_dna_of_lapy,
    pyfms_mesh,
    spectrum_of_pyfm,
    arrays_of_igl,
    a_pair,
    cotmatrix_of_igl,
    open3ds_mesh,
    open3ds_tensor_mesh,
    filter_with_o,
    filter_in_a_pipe,
    dry_run,
    help_of_a_command,
    info_for_a_program,
    a_part,
    without_colours,
    as_a_module,
    with_force,
]
REFUSED = [
    with_a_mesh_set,
    with_an_option_of_taubins,
    with_quadrangles,
    with_iterations,
    a_scene,
    a_path,
    eigenpairs_with_k,
    with_a_number_of_iterations,
    with_iterations_in_the_shell,
    several_files,
    a_misspelled_command,
]


@pytest.mark.parametrize("call", WORKING)
def test_it_works(call: Callable[[Path], None], scan: Path) -> None:
    call(scan)


@pytest.mark.parametrize("call", REFUSED)
def test_it_is_refused_with_the_remedy(call: Callable[[Path], None], scan: Path) -> None:
    call(scan)
