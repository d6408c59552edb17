"""Meshes of other libraries keep their type and their data; the input is unchanged."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import meshio
import meshlab_spectral
import numpy as np
import pymeshlab
import pytest
import pyvista
import trimesh
from meshlab_spectral import (
    FilterOptions,
    OptionError,
    PluginError,
    SpectralError,
    denoise_mesh,
    filter_colors,
    filter_mesh,
    filter_scalars,
    geometry_spectrum,
    manifold_harmonics,
    measure_artefacts,
    shape_dna,
)

_SPHERE = pyvista.Icosphere(nsub=3)
V, F = np.array(_SPHERE.points, dtype=float), np.array(_SPHERE.regular_faces)
EXPECTED, _ = filter_mesh(V, F, feature_size="30%")


def test_a_mesh_of_pyvista_keeps_its_type_and_data() -> None:
    mesh = pyvista.PolyData.from_regular_faces(V, F)
    mesh["height"] = V[:, 2]
    mesh.compute_normals(inplace=True, split_vertices=False)
    given = mesh.copy()
    moved, report = filter_mesh(mesh, feature_size="30%")
    assert isinstance(moved, pyvista.PolyData)
    assert report["warnings"] == []
    np.testing.assert_array_equal(moved.points, EXPECTED.astype(mesh.points.dtype))
    np.testing.assert_array_equal(moved["height"], mesh["height"])
    assert moved.point_data["Normals"].shape == V.shape
    assert mesh == given


def test_a_surface_of_nibabel_keeps_its_type_and_its_normals_follow() -> None:
    nibabel = pytest.importorskip("nibabel", reason="the extra formats is not installed")
    array, image = nibabel.gifti.GiftiDataArray, nibabel.gifti.GiftiImage()

    arrays = {
        "POINTSET": V,
        "TRIANGLE": F.astype(np.int32),
        "VECTOR": V / np.linalg.norm(V, axis=1, keepdims=True),
    }
    for intent, data in (arrays | {"SHAPE": V[:, 2]}).items():
        kept = data if intent == "TRIANGLE" else data.astype(np.float32)
        image.add_gifti_data_array(
            array(kept, intent=f"NIFTI_INTENT_{intent}", meta={"Name": intent.lower()})
        )
    W = V.astype(np.float32).astype(float)
    expected, _ = filter_mesh(W, F, feature_size="30%")
    moved, _ = filter_mesh(image, feature_size="30%")
    assert type(moved) is type(image)
    np.testing.assert_array_equal(moved.darrays[0].data, expected.astype(np.float32))
    assert not np.array_equal(moved.darrays[2].data, image.darrays[2].data)
    np.testing.assert_array_equal(image.darrays[0].data, V.astype(np.float32))
    values, _ = filter_scalars(image, "shape", feature_size="30%")
    np.testing.assert_allclose(
        values, filter_scalars(W, F, V[:, 2].astype(np.float32), feature_size="30%")[0]
    )


def test_a_mesh_of_pyvista_with_quadrangles_is_refused_with_the_advice_to_triangulate() -> None:
    with pytest.raises(ValueError, match=r"not triangles: call its triangulate\(\) first"):
        filter_mesh(pyvista.Plane(i_resolution=2, j_resolution=2))


def test_a_mesh_of_trimesh_keeps_its_type_and_metadata() -> None:
    mesh = trimesh.Trimesh(V, F, process=False, metadata={"name": "sphere"})
    moved, _ = filter_mesh(mesh, feature_size="30%")
    assert isinstance(moved, trimesh.Trimesh)
    assert moved.metadata["name"] == "sphere"
    np.testing.assert_array_equal(moved.vertices, EXPECTED)
    np.testing.assert_array_equal(mesh.vertices, V)


def test_a_mesh_of_meshio_keeps_its_precision() -> None:
    mesh = meshio.Mesh(
        V.astype(np.float32), {"triangle": F, "line": F[:2, :2]}, point_data={"height": V[:, 2]}
    )
    moved, _ = filter_mesh(mesh, feature_size="30%")
    assert isinstance(moved, meshio.Mesh)
    assert moved.points.dtype == np.float32
    np.testing.assert_allclose(moved.points, EXPECTED, atol=1e-6)
    np.testing.assert_array_equal(moved.point_data["height"], mesh.point_data["height"])


def test_a_mesh_of_meshio_with_other_cells_is_refused() -> None:
    mesh = meshio.Mesh(V, {"triangle": F, "tetra": F[:, [0, 1, 2, 0]]})
    with pytest.raises(ValueError, match="cells tetra, triangle: pass a mesh of triangles only"):
        filter_mesh(mesh)


def test_a_mesh_of_pymeshlab_keeps_quality_and_selection() -> None:
    mesh_set = pymeshlab.MeshSet()
    quality = np.linspace(0, 1, len(V))
    mesh_set.add_mesh(pymeshlab.Mesh(V, F, v_scalar_array=quality))
    mesh = mesh_set.current_mesh()
    moved, _ = filter_mesh(mesh, feature_size="30%")
    assert isinstance(moved, pymeshlab.Mesh)
    np.testing.assert_array_equal(moved.vertex_matrix(), EXPECTED)
    np.testing.assert_array_equal(moved.vertex_scalar_array(), quality)
    np.testing.assert_array_equal(mesh.vertex_matrix(), V)
    weighted, _ = filter_mesh(mesh, feature_size="30%", weight="vertex quality")
    by_arrays, _ = filter_mesh(V, F, feature_size="30%", weights=quality)
    np.testing.assert_array_equal(weighted.vertex_matrix(), by_arrays)


def test_a_mesh_of_pymeshlab_takes_all_that_arrays_take() -> None:
    colours = np.column_stack([np.abs(V), np.ones(len(V))])
    mesh = pymeshlab.Mesh(V, F, v_color_matrix=colours)
    stages: list[str] = []
    given: dict[str, Any] = {
        "feature_size": "30%",
        "weights": np.linspace(1, 0, len(V)),
        "selection": V[:, 2] > 0,
        "gain": lambda w: 1 / (1 + w**4),
        "progress": lambda stage, done: stages.append(stage),
        "threads": 1,
    }
    moved, report = filter_mesh(mesh, **given)
    expected, of_arrays = filter_mesh(V, F, **given)
    np.testing.assert_array_equal(moved.vertex_matrix(), expected)
    np.testing.assert_array_equal(moved.vertex_color_matrix(), mesh.vertex_color_matrix())
    assert (np.sum(moved.vertex_normal_matrix() * expected, axis=1) > 0).all()
    assert report == of_arrays
    assert stages
    details, _ = filter_mesh(mesh, result="details")
    np.testing.assert_array_equal(details, filter_mesh(V, F, result="details")[0])
    again, _ = filter_mesh(moved, **given)
    np.testing.assert_array_equal(again.vertex_matrix(), filter_mesh(expected, F, **given)[0])


def test_a_mesh_of_pymeshlab_keeps_the_heights_of_noise() -> None:
    X = V + 0.01 * np.random.default_rng(1).standard_normal(V.shape)
    moved, report = denoise_mesh(pymeshlab.Mesh(X, F), store_noise_height=True)
    heights = moved.vertex_custom_scalar_attribute_array("noise_height")
    np.testing.assert_array_equal(heights, report["noise_heights"])
    np.testing.assert_array_equal(moved.vertex_matrix(), denoise_mesh(X, F)[0])


def test_an_object_that_is_not_a_mesh_is_refused() -> None:
    with pytest.raises(TypeError, match="no faces with types's SimpleNamespace: pass vertices and"):
        filter_mesh(SimpleNamespace())
    with pytest.raises(TypeError, match=r"faces: pyvista\.PolyData has its own"):
        filter_mesh(pyvista.Sphere(), F)


def test_every_function_accepts_a_mesh() -> None:
    mesh = pyvista.PolyData.from_regular_faces(V, F)
    assert isinstance(denoise_mesh(mesh)[0], pyvista.PolyData)
    assert filter_scalars(mesh, values=V[:, 0])[0].shape == (len(V),)
    assert filter_colors(mesh, colors=np.abs(V))[0].shape == V.shape
    assert manifold_harmonics(mesh, basis_size=5).harmonics.shape == (len(V), 5)
    assert geometry_spectrum(mesh).area > 3


def test_after_a_mesh_the_arguments_by_position_are_those_after_the_faces() -> None:
    mesh = pyvista.PolyData.from_regular_faces(V, F)
    q, rgb = V[:, 0] ** 3, np.abs(V)
    mesh["q"], mesh["rgb"] = q, rgb
    options = FilterOptions(feature_size="20%")
    for of in (mesh, (V, F), trimesh.Trimesh(V, F, process=False), meshio.Mesh(V, {"triangle": F})):
        scalars = filter_scalars(of, q, options)[0]
        np.testing.assert_array_equal(scalars, filter_scalars(V, F, q, options)[0])
        np.testing.assert_array_equal(
            filter_colors(of, rgb, options)[0], filter_colors(V, F, rgb, options)[0]
        )
        basis = manifold_harmonics(of, 5)
        np.testing.assert_array_equal(basis.harmonics, manifold_harmonics(V, F, 5).harmonics)
        np.testing.assert_array_equal(shape_dna(of, 5), shape_dna(V, F, 5))
        assert geometry_spectrum(of, 5).area == geometry_spectrum(V, F, 5).area
        assert measure_artefacts(of, 0.5).rms == measure_artefacts(V, F, 0.5).rms
        moved = filter_mesh(of, options)[0]
        points = moved[0] if of == (V, F) else getattr(moved, "vertices", None)
        points = moved.points if points is None else points
        np.testing.assert_array_equal(points, filter_mesh(V, F, options)[0])


def test_arrays_of_a_mesh_may_be_named() -> None:
    q, rgb = np.abs(V[:, 0]) ** 3, np.abs(V)
    polydata = pyvista.PolyData.from_regular_faces(V, F)
    polydata["q"], polydata["rgb"], polydata["mask"] = q, rgb, V[:, 2] > 0
    of_trimesh = trimesh.Trimesh(V, F, process=False, vertex_attributes={"q": q, "rgb": rgb})
    of_meshio = meshio.Mesh(V, {"triangle": F}, point_data={"q": q, "rgb": rgb})
    for mesh in (polydata, polydata.cast_to_unstructured_grid(), of_trimesh, of_meshio):
        np.testing.assert_array_equal(filter_scalars(mesh, "q")[0], filter_scalars(V, F, q)[0])
        np.testing.assert_array_equal(filter_colors(mesh, "rgb")[0], filter_colors(V, F, rgb)[0])
        with pytest.raises(
            ValueError, match=r"values = 'p': the mesh has no such array.*'q', 'rgb"
        ):
            filter_scalars(mesh, "p")
    part, _ = filter_mesh(polydata, weights="q", selection="mask")
    by_arrays, _ = filter_mesh(V, F, weights=q, selection=V[:, 2] > 0)
    np.testing.assert_array_equal(part.points, by_arrays.astype(part.points.dtype))
    with pytest.raises(ValueError, match="have no named arrays"):
        filter_scalars(V, F, "q")


GRID = pyvista.ImageData(dimensions=(3, 3, 3))
QUADS = pyvista.Plane(i_resolution=2, j_resolution=2)


@pytest.mark.parametrize(
    ("mesh", "words"),
    [
        (pyvista.MultiBlock([_SPHERE]), r"combine\(\)\.extract_surface\(\)\.triangulate\(\)"),
        (trimesh.Scene([trimesh.Trimesh(V, F)]), r"to_mesh\(\)"),
        (GRID, r"pass its surface: extract_surface\(\)\.triangulate\(\)"),
        (GRID.cast_to_unstructured_grid(), r"surface, extract_surface\(\)\.triangulate\(\)"),
        (QUADS, r"call its triangulate\(\) first"),
        (_SPHERE.strip(), r"call its triangulate\(\) first"),
        (pyvista.PolyData(V), "no faces: reconstruct a surface first"),
        (pyvista.Line(), "no faces: reconstruct a surface first"),
        (trimesh.PointCloud(V), "no faces: reconstruct a surface first"),
        (meshio.Mesh(V, {"quad": F[:, [0, 1, 2, 0]]}), r"extract_surface\(\)\.triangulate\(\)"),
        ("scan.ply", r"pyvista\.read; or filter it with filter_files"),
        (Path("scan.ply"), r"pyvista\.read; or filter it with filter_files"),
        ((V, F[:, [0, 1, 2, 0]]), r"faces\[:, \[0, 2, 3\]\]"),
        ((V, [[0, 1, 2], [0, 1, 2, 3]]), "several numbers of corners: split them"),
        ([V], "pass vertices and faces, or a mesh: .*a tuple"),
        (None, "pass vertices and faces, or a mesh"),
    ],
)
def test_what_is_no_mesh_of_triangles_is_refused_with_the_remedy(mesh: Any, words: str) -> None:
    for call in (filter_mesh, denoise_mesh, manifold_harmonics, geometry_spectrum):
        with pytest.raises((TypeError, ValueError), match=words) as refused:
            call(mesh)
        assert isinstance(refused.value, SpectralError)


@pytest.mark.filterwarnings("ignore:The default value of `algorithm`")
def test_the_remedies_give_meshes_that_are_filtered() -> None:
    for remedied in (
        pyvista.MultiBlock([_SPHERE, QUADS]).combine().extract_surface().triangulate(),
        GRID.extract_surface().triangulate(),
        QUADS.triangulate(),
        _SPHERE.strip().triangulate(),
        trimesh.Scene([trimesh.Trimesh(V, F)]).to_mesh(),
        pyvista.from_meshio(meshio.Mesh(QUADS.points, {"quad": QUADS.regular_faces}))
        .extract_surface()
        .triangulate(),
    ):
        assert type(filter_mesh(remedied)[0]) is type(remedied)
    quads = QUADS.regular_faces
    assert filter_mesh(QUADS.points, np.vstack([quads[:, :3], quads[:, [0, 2, 3]]]))[0].shape == (
        9,
        3,
    )


def test_weights_scale_the_displacement_of_each_vertex() -> None:
    weights = np.linspace(0, 1, len(V))
    moved, _ = filter_mesh(V, F, feature_size="30%", weights=weights)
    np.testing.assert_allclose(moved, V + weights[:, None] * (EXPECTED - V), atol=1e-12)
    with pytest.raises(ValueError, match=rf"weights have shape \(3,\): pass {len(V)} numbers"):
        filter_mesh(V, F, weights=[0, 0.5, 1])
    with pytest.raises(OptionError, match="pass the quality as weights"):
        filter_mesh(V, F, weight="vertex quality")


def test_a_selection_may_be_of_vertices_or_of_faces() -> None:
    faces = np.flatnonzero(V[F, 2].min(axis=1) > 0)
    corners = np.zeros(len(V), dtype=bool)
    corners[F[faces]] = True
    by_faces, _ = filter_mesh(V, F, feature_size="30%", selection=faces)
    by_corners, _ = filter_mesh(V, F, FilterOptions(feature_size="30%"), selection=corners)
    np.testing.assert_array_equal(by_faces, by_corners)
    moved = np.linalg.norm(by_faces - V, axis=1)
    assert moved[V[:, 2] > 0.5].min() > 0.1 * np.linalg.norm(EXPECTED - V, axis=1).max()
    assert moved[V[:, 2] < -0.9].max() < 1e-3
    denoised, _ = denoise_mesh(V, F, selection=corners)
    assert denoised.shape == V.shape
    with pytest.raises(OptionError, match="pass the selected vertices or faces as selection"):
        filter_mesh(V, F, selected=True)
    with pytest.raises(ValueError, match=rf"selection has face {len(F)}, but"):
        filter_mesh(V, F, selection=[0, len(F)])
    with pytest.raises(ValueError, match=r"numpy\.flatnonzero"):
        filter_mesh(V, F, selection=np.ones(len(F), dtype=bool))
    for mask in (V[:, 2] > 0).astype(np.uint8), (V[:, 2] > 0).astype(float):
        with pytest.raises(ValueError, match=r"pass booleans, such as selection\.astype\(bool\)"):
            filter_mesh(V, F, selection=mask)


def test_a_gain_may_be_any_function_of_w() -> None:
    # In one step, which is evaluated more accurately than automatic ones.
    text, _ = filter_mesh(
        V, F, filter_type="custom", transfer_function="1/(1 + w^4)", feature_size="30%", steps=1
    )
    function, _ = filter_mesh(V, F, feature_size="30%", steps=1, gain=lambda w: 1 / (1 + w**4))
    scale = np.abs(text - V).max()
    np.testing.assert_allclose(function, text, atol=1e-4 * scale)
    low, _ = filter_scalars(V, F, V[:, 0] ** 3, feature_size="30%")
    same, _ = filter_scalars(
        V, F, V[:, 0] ** 3, feature_size="30%", gain=lambda w: 2 ** (-(w**2) / 2)
    )
    np.testing.assert_allclose(same, low, atol=1e-4)


@pytest.mark.parametrize("wrong", [-1.0, np.nan, np.inf])
def test_a_gain_must_be_finite_and_not_negative(wrong: float) -> None:
    with pytest.raises(OptionError, match=r"gain\(.*\) = .*: must be finite and not negative"):
        filter_mesh(V, F, gain=lambda w: wrong if w > 3 else 1.0)
    with pytest.raises(OptionError, match=r"gain = '1/\(1 \+ w\)': pass a function of w"):
        filter_mesh(V, F, gain="1/(1 + w)")  # type: ignore[call-overload]
    with pytest.raises(OptionError, match="filter_type = high-pass: gain replaces it"):
        filter_mesh(V, F, gain=lambda w: 1.0, filter_type="high-pass")


def test_arrays_are_filtered_without_pymeshlab(monkeypatch: pytest.MonkeyPatch) -> None:
    expected, _ = filter_mesh(V, F)
    monkeypatch.setitem(sys.modules, "pymeshlab", None)
    filtered, _ = filter_mesh(V, F)
    np.testing.assert_array_equal(filtered, expected)
    with pytest.raises(PluginError, match="pymeshlab"):
        meshlab_spectral.load()
