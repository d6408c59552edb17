"""VTK files keep everything but coordinates and normals."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista as pv
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats import vtk
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter

LEGACY = """# vtk DataFile Version 3.0
A title: POINTS 7 float
ASCII
DATASET POLYDATA
POINTS 6 double
0 0 0 1 0 0 1 1 0 0 1 0 0.5 0.5 1 2 2 2
VERTICES 1 2
1 4
POLYGONS 2 9
4 0 1 2 3
3 0 1 4
TRIANGLE_STRIPS 1 5
4 0 1 3 4
CELL_DATA 4
NORMALS flat float
0 0 1 0 0 1 0 -1 0 0 0 1
POINT_DATA 6
SCALARS age double
LOOKUP_TABLE default
0.1234567890123456 2 3 4 5 6
"""


def written(folder: Path, name: str = "m.vtp", binary: bool = True) -> Path:
    """Write a sphere with something of each kind."""
    mesh = pv.Sphere(theta_resolution=7, phi_resolution=6).compute_normals(split_vertices=False)
    mesh.point_data.set_scalars(np.arange(mesh.n_points) / 3, "age")
    mesh.point_data["wind"] = np.arange(3.0 * mesh.n_points).reshape(-1, 3)
    mesh.cell_data["part"] = np.arange(mesh.n_cells, dtype=np.int16)
    mesh.field_data["maker"] = ["someone", "else"]
    mesh = mesh.cast_to_unstructured_grid() if name[0] == "u" else mesh
    mesh.save(folder / name, binary=binary)
    return folder / name


def legacy(folder: Path, old: str = "", new: str = "") -> Path:
    (folder / "legacy.vtk").write_text(LEGACY.replace(old, new, 1))
    return folder / "legacy.vtk"


def saved(path: Path, after: np.ndarray[Any, Any]) -> tuple[Any, list[str]]:
    warnings = vtk.read(path).save(target := path.with_name("saved" + path.suffix), [after])
    return pv.read(target), warnings


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("name", ["m.vtk", "m.vtp", "u.vtk", "u.vtu"])
def test_only_points_and_normals_change(name: str, binary: bool, tmp_path: Path) -> None:
    path = written(tmp_path, name, binary)
    old, document = pv.read(path), vtk.read(path)
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, old.points)
    np.testing.assert_array_equal(part.quality, old.point_data["age"])
    assert {"array wind", "array part", "array maker"} < set(document.contents)
    after = np.vstack([part.vertices[:3], part.vertices[3:] * [1, 2, 3]])
    new, warnings = saved(path, after)
    assert (warnings, new.points.dtype) == ([], np.float32)
    np.testing.assert_array_equal(new.points, after.astype(np.float32))
    for key in set(old.array_names) - {"Normals"}:
        assert old[key].dtype == new[key].dtype
        np.testing.assert_array_equal(old[key], new[key])
    expected = pv.PolyData.from_regular_faces(after, part.faces).compute_normals(
        split_vertices=False, consistent_normals=False
    )
    np.testing.assert_allclose(new.cell_data["Normals"], expected.cell_data["Normals"], atol=1e-6)
    cosines = (new.point_data["Normals"] * expected.point_data["Normals"]).sum(axis=1)
    assert (cosines > 0.8).all()
    data = (tmp_path / f"saved{path.suffix}").read_bytes()
    assert (b'format="ascii"' in data) == (path.suffix != ".vtk" and not binary)
    if path.suffix == ".vtk" and not binary:  # of the text only numbers differ
        words = re.compile(rb"-?\d[\d.e+-]*")
        assert words.sub(b"0", data) == words.sub(b"0", path.read_bytes())
    saved(path, part.vertices)
    assert (tmp_path / f"saved{path.suffix}").read_bytes() == path.read_bytes()


def test_values_after_the_name_of_a_lookup_table_are_no_count(tmp_path: Path) -> None:
    for first in ("-1", "90000000000"):
        path = legacy(tmp_path, "0.1234567890123456 2", f"{first} 2")
        assert vtk.read(path).parts[0].quality[0] == float(first)


def test_points_become_double_where_single_precision_loses_the_movement(tmp_path: Path) -> None:
    path = written(tmp_path)
    after = vtk.read(path).parts[0].vertices + 1e-9
    new, (warning,) = saved(path, after)
    assert "double precision" in warning
    np.testing.assert_array_equal(new.points, after)


def test_points_polygons_and_strips_of_a_legacy_text_keep_all_digits(tmp_path: Path) -> None:
    path = legacy(tmp_path)
    (part,) = vtk.read(path).parts
    assert part.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4], [0, 1, 3], [1, 4, 3]]
    after = part.vertices.copy()
    after[4, 2] = 1 / 3
    new, _ = saved(path, after)
    np.testing.assert_array_equal(new.points, after)
    np.testing.assert_array_equal(new["age"], [0.1234567890123456, 2, 3, 4, 5, 6])
    # The vertex and the square have not moved; the triangle's normal stays on its side.
    expected = [[0, 0, 1], [0, 0, 1], np.array([0, -1 / 3, 0.5]) / np.hypot(1 / 3, 0.5)]
    np.testing.assert_allclose(new.cell_data["flat"][:3], expected, atol=1e-6)


DAMAGE = {
    ("# vtk", "vtk"): "Unrecognized file type",
    ("POINTS 6", "POINTS 99999999999999"): "99999999999999",
    ("0 0 0 1", "0 nan 0 1"): "vertex 0 is at 0 nan 0",
    ("4 0 1 2 3", "4 0 1 2 6"): "not among its 6 points",
    ("POINT_DATA 6", "POINT_DATA 5"): "attribute",
    (LEGACY[LEGACY.index(" 2 2\nVERTICES") :], ""): "has 16 numbers of 18 in its points",
    (LEGACY[-8:], ""): "has 2 numbers of 6 in its last array",
    (LEGACY[LEGACY.index(" 1\nPOINT_DATA") :], ""): "has 11 numbers of 12 in its last array",
}


@pytest.mark.parametrize(("damage", "message"), DAMAGE.items())
def test_a_damaged_file_is_refused(damage: tuple[str, str], message: str, tmp_path: Path) -> None:
    with pytest.raises(MeshFileError, match=message):
        vtk.read(legacy(tmp_path, *damage))


def test_the_last_line_may_lack_its_end(tmp_path: Path) -> None:
    whole = LEGACY[: LEGACY.index("\nPOINT_DATA")]
    assert len(vtk.read(legacy(tmp_path, LEGACY, whole)).parts[0].vertices) == 6


def test_volume_cells_are_refused_with_a_remedy(tmp_path: Path) -> None:
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: np.array([[0, 1, 2, 3]])}, np.eye(4, 3))
    grid.save(tmp_path / "volume.vtu")
    with pytest.raises(MeshFileError, match="Extract Surface"):
        vtk.read(tmp_path / "volume.vtu")


@pytest.mark.parametrize("version", ["3.0", "5.1"])
@pytest.mark.parametrize("is_far", [False, True])
def test_the_lines_before_binary_data_are_kept(version: str, is_far: bool, tmp_path: Path) -> None:
    """Slicer says in the title which way the axes point."""
    sphere = pv.Icosphere(nsub=2).compute_normals()
    sphere.points = np.float32(sphere.points + is_far * 1e6)
    sphere.save(tmp_path / "in.vtk")
    content = (tmp_path / "in.vtk").read_bytes()
    _, _, rest = content.split(b"\n", 2)
    if version == "3.0":
        writer = vtkPolyDataWriter()
        writer.SetInputData(sphere)
        writer.SetFileTypeToBinary()
        writer.SetFileVersion(42)
        writer.SetFileName(str(tmp_path / "in.vtk"))
        writer.Write()
        _, _, rest = (tmp_path / "in.vtk").read_bytes().split(b"\n", 2)
    head = b"# vtk DataFile Version " + version.encode() + b"\nSlicer output. SPACE=RAS\n"
    (tmp_path / "in.vtk").write_bytes(head + rest)
    document = vtk.read(tmp_path / "in.vtk")
    moved = document.parts[0].vertices + 0.01 * np.sin(9 * document.parts[0].vertices)
    warnings = document.save(tmp_path / "out.vtk", [moved])
    assert len(warnings) == is_far
    after = (tmp_path / "out.vtk").read_bytes()
    assert after.startswith(head)
    np.testing.assert_allclose(vtk.read(tmp_path / "out.vtk").parts[0].vertices, moved, atol=1e-6)
    seen = pv.read(tmp_path / "out.vtk")
    assert seen.points.dtype == (np.float64 if is_far else np.float32)
    assert seen.faces.tolist() == sphere.faces.tolist()
    np.testing.assert_allclose(np.linalg.norm(seen.point_data["Normals"], axis=1), 1, atol=1e-6)
    assert (seen.point_data["Normals"] != sphere.point_data["Normals"]).any()
