"""Polygons are triangulated without folds, in every format, and as MeshLab does where it can."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista
from helpers import loaded
from hypothesis import given, settings
from hypothesis import strategies as st
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.document import Array, Indices
from meshlab_spectral.formats.opening import open_document
from meshlab_spectral.formats.polygons import triangles

L_SHAPE = [[0, 0, 0], [4, 0, 0], [4, 1, 0], [1, 1, 0], [1, 4, 0], [0, 4, 0]]
FORMATS = ["ply", "obj", "off", "vtk", "vtp"]


def write(path: Path, vertices: Array, polygons: list[list[int]]) -> Path:
    rows = [" ".join(f"{x:.17g}" for x in row) for row in vertices.tolist()]
    counted = [f"{len(one)} {' '.join(map(str, one))}" for one in polygons]
    if path.suffix == ".ply":
        axes = "".join(f"property double {axis}\n" for axis in "xyz")
        rows = [
            f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n{axes}element face {len(counted)}",
            "property list int int vertex_indices\nend_header",
            *rows,
            *counted,
        ]
    elif path.suffix == ".obj":
        faces = ["f " + " ".join(str(k + 1) for k in one) for one in polygons]
        rows = [*(f"v {row}" for row in rows), *faces]
    elif path.suffix == ".off":
        rows = [f"OFF\n{len(rows)} {len(counted)} 0", *rows, *counted]
    else:
        faces = np.array([word for one in counted for word in map(int, one.split())])
        pyvista.PolyData(vertices, faces).save(path)
        return path
    path.write_text("\n".join([*rows, ""]))
    return path


def areas(vertices: Array, faces: Indices) -> Array:
    P = vertices[faces]
    return np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]) / 2


@pytest.mark.parametrize("first", range(6))
@pytest.mark.parametrize("format_", FORMATS)
def test_an_l_shaped_cap_keeps_its_area(format_: str, first: int, tmp_path: Path) -> None:
    polygon = np.roll(np.arange(6), first).tolist()
    path = write(tmp_path / f"cap.{format_}", np.array(L_SHAPE, float), [polygon])
    (part,) = open_document(path).parts
    vectors = areas(part.vertices, part.faces)
    assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(7)
    np.testing.assert_allclose(vectors.sum(axis=0), [0, 0, 7], atol=1e-12)


@pytest.mark.parametrize("format_", ["ply", "obj", "off"])
def test_a_polygon_of_a_vertex_too_many_is_refused(format_: str, tmp_path: Path) -> None:
    path = write(tmp_path / f"cap.{format_}", np.array(L_SHAPE, float), [[0, 1, 2, 3, 5, 6]])
    with pytest.raises(MeshFileError, match=r"cap\."):
        open_document(path)


@settings(max_examples=200, deadline=None)
@given(st.integers(4, 40), st.integers(0, 2**32 - 1), st.booleans())
def test_a_plane_polygon_without_crossings_is_covered_once(
    size: int, seed: int, is_comb: bool
) -> None:
    rng = np.random.default_rng(seed)
    if is_comb:  # no corner sees all of it
        x = np.arange(size)
        outline = np.column_stack([x, np.where(x % 2, rng.uniform(2, 5, size), 1)])
        outline = np.vstack([[[-1, 0], [size, 0]], outline[::-1]])
    else:  # seen from the origin
        angles = (np.arange(size) + rng.uniform(0, 0.9, size)) * 2 * np.pi / size
        distances = rng.uniform(0.1, 1, size)
        outline = distances[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    (x, y), (a, b) = outline.T, np.roll(outline, -1, axis=0).T
    area = (x * b - y * a).sum() / 2
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    vertices = np.column_stack([outline, 0 * x]) @ turn.T + rng.normal(size=3)
    polygon = np.roll(np.arange(len(x)), rng.integers(len(x)))
    faces = triangles(polygon, np.array([len(x)]), vertices)
    assert sorted(set(faces.ravel().tolist())) == list(range(len(x)))
    vectors = areas(vertices, faces)
    assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(area, rel=1e-9)
    np.testing.assert_allclose(vectors.sum(axis=0), turn[:, 2] * np.linalg.det(turn) * area)


@pytest.mark.parametrize("format_", ["ply", "obj"])
def test_bent_quadrilaterals_are_split_as_meshlab_splits_them(format_: str, tmp_path: Path) -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    vertices = np.vstack([np.add(square, [2 * k, 0, 0]) for k in range(100)])
    vertices += np.random.default_rng(5).normal(0, 0.12, vertices.shape)
    path = write(tmp_path / f"in.{format_}", vertices, np.arange(400).reshape(-1, 4).tolist())
    mesh_set = loaded(path)
    (part,) = open_document(path).parts
    np.testing.assert_array_equal(part.faces, mesh_set.current_mesh().face_matrix())


@pytest.mark.parametrize("format_", FORMATS)
def test_every_format_splits_alike(format_: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(6)
    sizes = rng.integers(3, 9, 50)
    polygons, vertices = [], rng.normal(size=(sizes.sum(), 3))
    for size in sizes.tolist():
        begin = sum(map(len, polygons))
        angles = np.sort(rng.uniform(0, 2 * np.pi, size))
        vertices[begin : begin + size] *= 0.2
        vertices[begin : begin + size, :2] += np.column_stack([np.cos(angles), np.sin(angles)])
        polygons.append(list(range(begin, begin + size)))
    vertices = vertices.astype("f4").astype(float)
    (part,) = open_document(write(tmp_path / f"in.{format_}", vertices, polygons)).parts
    expected = triangles(np.arange(len(vertices)), sizes, vertices)
    np.testing.assert_array_equal(part.faces, expected)
