"""The page in real browsers; other programs open what it saves."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import pyvista
import trimesh
from helpers import loaded, mesh_set_of
from meshlab_spectral import denoise_mesh
from numpy.typing import NDArray
from PIL import Image
from plyfile import PlyData, PlyElement

REPOSITORY = Path(__file__).resolve().parents[3]
BUILD = REPOSITORY / "build" / "web"
SINGLE = 1e-6
PROGRAMS = {"chromium": "chromium", "firefox": "firefox-esr"}
Arrays = tuple[NDArray[np.float64], NDArray[np.int64]]


@pytest.fixture(params=PROGRAMS)
def browser(request: pytest.FixtureRequest) -> str:
    is_there = shutil.which(PROGRAMS[request.param]) is not None
    if not (is_there and (BUILD / "site").is_dir() and (BUILD / "tests" / "node_modules").is_dir()):
        pytest.skip(f"no page, or no {request.param} and its driver: make web-test")
    for file in (REPOSITORY / "tests" / "web").glob("*.mjs"):  # next to the driver
        shutil.copy(file, BUILD / "tests")
    return str(request.param)


def noisy_sphere() -> Arrays:
    mesh = trimesh.creation.icosphere(subdivisions=5)
    noise = 0.006 * np.random.default_rng(2).standard_normal(len(mesh.vertices))
    return mesh.vertices * (1 + noise[:, None]), mesh.faces


def write_scan(path: Path, V: NDArray[np.float64], F: NDArray[np.int64]) -> None:
    vertex = np.array([tuple(v) for v in V], [(axis, "f8") for axis in "xyz"])
    face = np.array([(f,) for f in F], [("vertex_indices", "i4", (3,))])
    elements = [PlyElement.describe(vertex, "vertex"), PlyElement.describe(face, "face")]
    PlyData(elements).write(path)


def write_huge(path: Path) -> None:
    """A grid of 3.8 million vertices: more than fits into WebAssembly."""
    n = 1950
    face = np.zeros(2 * (n - 1) ** 2, [("size", "u1"), ("corners", "<i4", 3)])
    first = (n * np.arange(n - 1)[:, None] + np.arange(n - 1)).ravel()
    face["size"] = 3
    face["corners"][::2] = first[:, None] + [0, n, 1]
    face["corners"][1::2] = first[:, None] + [1, n, n + 1]
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {n * n}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz")
    header += f"element face {len(face)}\nproperty list uchar int vertex_indices\nend_header\n"
    V = np.column_stack([*np.divmod(np.arange(n * n), n), np.arange(n * n) % 7]).astype("<f4")
    path.write_bytes(header.encode() + V.tobytes() + face.tobytes())


def write_segmentation(path: Path) -> None:
    x, y, z = np.mgrid[-1:1:50j, -1:1:50j, -1:1:50j]
    inside = (np.sqrt((np.sqrt(x**2 + y**2) - 0.6) ** 2 + z**2) < 0.27).astype("f4")
    grid = pyvista.ImageData(dimensions=inside.shape)
    grid["inside"] = inside.ravel("F")
    surface = grid.contour([0.5], scalars="inside").triangulate()
    trimesh.Trimesh(surface.points, surface.regular_faces, process=False).export(path)


def write_textured(path: Path, V: NDArray[np.float64], F: NDArray[np.int64]) -> None:
    mesh = trimesh.Trimesh(V, F, process=False)
    image = Image.fromarray(np.arange(192, dtype="u1").reshape(8, 8, 3))
    mesh.visual = trimesh.visual.TextureVisuals(uv=V[:, :2], image=image)
    _ = mesh.vertex_normals  # then they are written
    mesh.export(path)


def write_part(path: Path, V: NDArray[np.float64], F: NDArray[np.int64]) -> None:
    mesh_set_of(V, F).save_current_mesh(str(path))


def read(path: Path) -> Arrays:
    if path.suffix == ".3mf":  # MeshLab reads it by lib3mf
        mesh_set = loaded(path)
        return mesh_set.current_mesh().vertex_matrix(), mesh_set.current_mesh().face_matrix()
    mesh = trimesh.load(path, process=False, force="mesh")
    return mesh.vertices, mesh.faces


def test_what_the_page_saves_is_what_python_gives(browser: str, tmp_path: Path) -> None:
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    V, F = noisy_sphere()
    write_scan(meshes / "scan.ply", V, F)
    write_segmentation(meshes / "segmentation.obj")
    write_textured(meshes / "textured.glb", V, F)
    write_part(meshes / "part.3mf", V, F)
    trimesh.creation.annulus(1, 2, 1, sections=90).export(meshes / "cad.stl")
    write_huge(meshes / "huge.ply")
    (meshes / "broken.ply").write_bytes((meshes / "scan.ply").read_bytes()[:90000])

    target = BUILD / "pictures" / browser
    shutil.rmtree(target, ignore_errors=True)
    script = BUILD / "tests" / "try_page.mjs"
    page = BUILD / "site" / "browser"
    command = ["node", str(script), browser, str(page), str(meshes), str(target)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr

    assert (target / "cad.stl").read_bytes() == (meshes / "cad.stl").read_bytes()
    expected, _ = denoise_mesh(V, F)
    ply = PlyData.read(target / "scan.ply")["vertex"]
    np.testing.assert_allclose(
        np.column_stack([ply[axis] for axis in "xyz"]), expected, rtol=0, atol=1e-9
    )
    for name in ("segmentation.obj", "textured.glb", "part.3mf"):
        (before, faces), (after, faces_after) = read(meshes / name), read(target / name)
        np.testing.assert_array_equal(faces_after, faces)
        result, _ = denoise_mesh(before, faces)
        assert np.abs(result - before).max() > 100 * SINGLE
        scale = np.abs(before).max()
        np.testing.assert_allclose(after, result, rtol=0, atol=SINGLE * scale)
    glb = trimesh.load(target / "textured.glb", process=False, force="mesh")
    np.testing.assert_array_equal(np.asarray(glb.visual.material.baseColorTexture).shape, (8, 8, 3))
    fresh = trimesh.Trimesh(glb.vertices, glb.faces, process=False).vertex_normals
    assert np.einsum("ij,ij->i", glb.vertex_normals, fresh).min() > 0.99


def test_the_packed_package_works_as_its_readme_says(browser: str, tmp_path: Path) -> None:
    (archive,) = BUILD.glob("*.tgz")
    script = BUILD / "tests" / "try_package.mjs"
    command = ["node", str(script), browser, str(archive), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
