"""Normals that a mesh of any library stores are those of the result, not of the input."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import meshio
import numpy as np
import pytest
import pyvista
import trimesh
from meshlab_spectral import denoise_mesh, filter_mesh
from meshlab_spectral.formats import normals as of_package
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SPHERE = pyvista.Icosphere(nsub=3)
F = np.array(_SPHERE.regular_faces)
V = np.array(_SPHERE.points, dtype=float)
V += 0.03 * np.random.default_rng(1).normal(size=V.shape)
# Away from every axis, so that no coordinate of a normal is special.
TANGENT = np.array([0.36, 0.48, 0.8])


def face_normals(V: Array) -> Array:
    normals = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def vertex_normals(V: Array) -> Array:
    """Weighted by the areas of faces, as Open3D has them."""
    normals = np.zeros_like(V)
    a, b, c = (V[F[:, corner]] for corner in range(3))
    np.add.at(normals, F, np.cross(b - a, c - a)[:, None])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def degrees(a: Any, b: Any) -> float:
    cosines = (np.asarray(a, dtype=float) * np.asarray(b, dtype=float)).sum(axis=1)
    return float(np.degrees(np.arccos(np.clip(cosines, -1, 1)).max()))


class Tensor:
    """What open3d.core.Tensor offers."""

    def __init__(self, values: NDArray[Any]) -> None:
        self.values, self.device = np.array(values), "CPU:0"

    def cpu(self) -> Tensor:
        return self

    def to(self, device: str) -> Tensor:
        assert device == self.device
        return self

    def numpy(self) -> NDArray[Any]:
        return self.values


class TensorMap(dict[str, Tensor]):
    """What open3d.t.geometry.TensorMap offers."""

    def __getattr__(self, name: str) -> Tensor:
        return self[name]

    def __setattr__(self, name: str, value: Tensor) -> None:
        self[name] = value


class TensorMesh:
    """What open3d.t.geometry.TriangleMesh offers."""

    def __init__(self, vertex: dict[str, Tensor], triangle: dict[str, Tensor]) -> None:
        self._vertex, self._triangle = TensorMap(vertex), TensorMap(triangle)

    @property
    def vertex(self) -> TensorMap:
        return self._vertex

    @property
    def triangle(self) -> TensorMap:
        return self._triangle

    def clone(self) -> TensorMesh:
        return TensorMesh(self._vertex, self._triangle)


class Open3dMesh:
    """What open3d.geometry.TriangleMesh offers; its vectors are lists of points here."""

    def __init__(self, other: Open3dMesh | None = None) -> None:
        if other is not None:
            self.__dict__.update(other.__dict__)
        else:
            self.vertices: list[Any] = V.tolist()
            self.triangles = F.tolist()
            self.vertex_colors: list[Any] = []
            self.vertex_normals: list[Any] = []
            self._triangle_normals: list[Any] = []

    @property
    def triangle_normals(self) -> list[Any]:
        return self._triangle_normals

    @triangle_normals.setter
    def triangle_normals(self, values: list[Any]) -> None:
        self._triangle_normals = values


Made = tuple[Any, Callable[[Any], Array], Callable[[Any], dict[str, Any]]]


def pyvista_mesh(at_vertices: dict[str, Any], at_faces: dict[str, Any]) -> Made:
    mesh = pyvista.PolyData.from_regular_faces(V, F)
    mesh.point_data.update(at_vertices)
    mesh.cell_data.update(at_faces)
    return mesh, lambda m: m.points, lambda m: {**m.cell_data, **m.point_data}


def pyvista_grid(at_vertices: dict[str, Any], at_faces: dict[str, Any]) -> Made:
    mesh, points, data = pyvista_mesh(at_vertices, at_faces)
    return mesh.cast_to_unstructured_grid(), points, data


def meshio_mesh(at_vertices: dict[str, Any], at_faces: dict[str, Any]) -> Made:
    cells = [("triangle", F[:400]), ("line", F[:5, :2]), ("triangle", F[400:])]
    cell_data = {
        name: [values[:400], np.zeros((5, *values.shape[1:])), values[400:]]
        for name, values in at_faces.items()
    }
    mesh = meshio.Mesh(V, cells, point_data=dict(at_vertices), cell_data=cell_data)
    return (
        mesh,
        lambda m: m.points,
        lambda m: {
            **{name: np.concatenate([of[0], of[2]]) for name, of in m.cell_data.items()},
            **m.point_data,
        },
    )


def trimesh_mesh(at_vertices: dict[str, Any], at_faces: dict[str, Any]) -> Made:
    mesh = trimesh.Trimesh(
        V, F, process=False, vertex_attributes=at_vertices, face_attributes=at_faces
    )
    return mesh, lambda m: m.vertices, lambda m: {**m.face_attributes, **m.vertex_attributes}


def tensor_mesh(at_vertices: dict[str, Any], at_faces: dict[str, Any]) -> Made:
    mesh = TensorMesh(
        {"positions": Tensor(V), **{k: Tensor(v) for k, v in at_vertices.items()}},
        {"indices": Tensor(F), **{k: Tensor(v) for k, v in at_faces.items()}},
    )
    return (
        mesh,
        lambda m: m.vertex.positions.numpy(),
        lambda m: {k: v.numpy() for k, v in {**m.triangle, **m.vertex}.items()},
    )


LIBRARIES = [pyvista_mesh, pyvista_grid, meshio_mesh, trimesh_mesh, tensor_mesh]
NAMES = ["Normals", "normals", "vertex_normals", "SurfaceNormal", "nx ny nz", "normal_x"]


def smoothed(mesh: Any) -> Any:
    return filter_mesh(mesh, feature_size="30%")[0]


def denoised(mesh: Any) -> Any:
    return denoise_mesh(mesh)[0]


@pytest.mark.parametrize(
    ("library", "name", "side", "filtered"),
    [
        *((library, name, 1.0, smoothed) for library in LIBRARIES for name in NAMES),
        *((library, "Normals", -1.0, denoised) for library in LIBRARIES),
        *((pyvista_mesh, name, -1.0, smoothed) for name in [*NAMES, "Normals:x"]),
    ],
)
def test_normals_follow_on_their_side(
    library: Callable[..., Made], name: str, side: float, filtered: Callable[[Any], Any]
) -> None:
    at_vertices, at_faces = side * vertex_normals(V), side * face_normals(V)
    names = name.split() if " " in name else None
    if name[-2:] in ("_x", ":x"):
        names = [name[:-1] + axis for axis in "xyz"]
    if names is None:
        other = f"Cell{name}"
        mesh, points, data = library({name: at_vertices}, {other: at_faces})
        moved = filtered(mesh)
        found, of_faces = data(moved)[name], data(moved)[other]
    else:
        columns = dict(zip(names, at_vertices.T.copy(), strict=True))
        of_cells = {f"{n}": c for n, c in zip(names, at_faces.T.copy(), strict=True)}
        mesh, points, data = library(columns, {})
        moved = filtered(mesh)
        found = np.column_stack([data(moved)[n] for n in names])
        cells, _, data = library({}, of_cells)
        of_faces = np.column_stack([data(filtered(cells))[n] for n in names])
    X = np.asarray(points(moved), dtype=float)
    assert np.linalg.norm(X - V, axis=1).max() > 0.03
    assert degrees(at_vertices, side * vertex_normals(X)) > 20
    assert degrees(found, side * vertex_normals(X)) < 0.05
    assert degrees(of_faces, side * face_normals(X)) < 0.05
    np.testing.assert_array_equal(points(mesh), V.astype(np.asarray(points(mesh)).dtype))
    if names is None:
        np.testing.assert_array_equal(data(mesh)[name], at_vertices)


@pytest.mark.parametrize("library", LIBRARIES)
def test_other_data_stays(library: Callable[..., Made]) -> None:
    rng = np.random.default_rng(3)
    at_vertices = {
        "velocity": rng.normal(size=V.shape),
        "normalized_height": rng.uniform(size=len(V)),
        "normal_map": rng.integers(0, 9, len(V)),
        "nx": rng.uniform(size=len(V)),
        "rgb": rng.uniform(size=V.shape),
    }
    at_faces = {"normal_stress": rng.uniform(size=len(F)), "label": rng.integers(0, 9, len(F))}
    mesh, _, data = library(at_vertices, at_faces)
    after = data(filter_mesh(mesh, feature_size="30%")[0])
    for name, values in {**at_vertices, **at_faces}.items():
        np.testing.assert_array_equal(after[name], values, err_msg=name)


@pytest.mark.parametrize("library", LIBRARIES)
def test_tangents_stay_perpendicular_to_the_normals(library: Callable[..., Made]) -> None:
    normals = vertex_normals(V)
    tangents = np.cross(normals, TANGENT)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    mesh, points, data = library({"Normals": normals, "Tangents": tangents}, {})
    moved = filter_mesh(mesh, feature_size="30%")[0]
    after = data(moved)["Tangents"]
    np.testing.assert_allclose(np.linalg.norm(after, axis=1), 1, atol=1e-6)
    dots = (after * vertex_normals(np.asarray(points(moved), dtype=float))).sum(axis=1)
    np.testing.assert_allclose(dots, 0, atol=1e-5)


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_mesh_without_normals_gets_none(library: Callable[..., Made]) -> None:
    mesh, _, data = library({}, {})
    assert set(data(filter_mesh(mesh)[0])) == set(data(mesh))


def test_the_normals_of_vtk_are_found_under_any_name() -> None:
    mesh = pyvista.PolyData.from_regular_faces(V, F)
    mesh.point_data["directions"] = vertex_normals(V)
    mesh.point_data.active_normals_name = "directions"
    moved, _ = filter_mesh(mesh, feature_size="30%")
    X = np.asarray(moved.points, dtype=float)
    assert degrees(moved.point_data["directions"], vertex_normals(X)) < 0.05
    assert moved.point_data.active_normals_name == "directions"


def test_what_trimesh_caches_is_of_the_result() -> None:
    mesh = trimesh.Trimesh(V, F, process=False, vertex_normals=vertex_normals(V))
    cached = ("vertex_normals", "face_normals", "area_faces", "volume", "center_mass", "bounds")
    for name in cached:
        getattr(mesh, name)
    moved, _ = filter_mesh(mesh, feature_size="30%")
    fresh = trimesh.Trimesh(moved.vertices, F, process=False)
    for name in cached:
        np.testing.assert_allclose(getattr(moved, name), getattr(fresh, name), err_msg=name)


@pytest.mark.parametrize("with_vertices", [True, False])
@pytest.mark.parametrize("with_triangles", [True, False])
def test_normals_of_open3d_follow(with_vertices: bool, with_triangles: bool) -> None:
    mesh = Open3dMesh()
    if with_vertices:
        mesh.vertex_normals = vertex_normals(V).tolist()
    if with_triangles:
        mesh.triangle_normals = face_normals(V).tolist()
    moved, _ = filter_mesh(mesh, feature_size="30%")
    assert isinstance(moved, Open3dMesh)
    X = np.array(moved.vertices)
    assert len(moved.vertex_normals) == with_vertices * len(V)
    assert len(moved.triangle_normals) == with_triangles * len(F)
    if with_vertices:
        assert degrees(moved.vertex_normals, vertex_normals(X)) < 0.05
    if with_triangles:
        assert degrees(moved.triangle_normals, face_normals(X)) < 0.05
    assert mesh.vertices == V.tolist()


def test_faces_of_both_orientations_keep_their_normals_outward() -> None:
    turned = F.copy()
    turned[::2] = turned[::2, ::-1]
    normals = vertex_normals(V)
    mesh = meshio.Mesh(V, {"triangle": turned}, point_data={"Normals": normals})
    moved, _ = filter_mesh(mesh, feature_size="30%")
    assert degrees(moved.point_data["Normals"], vertex_normals(moved.points)) < 2


def test_vertices_without_faces_have_zeros_for_a_normal() -> None:
    found = of_package.vertex_normals(np.vstack([V, V[:1]]), F)
    np.testing.assert_allclose(found[:-1], vertex_normals(V), atol=1e-12)
    np.testing.assert_array_equal(found[-1], 0)
