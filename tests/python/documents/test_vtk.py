"""VTK files keep everything but coordinates and normals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from meshlab_spectral.documents import vtk

pv = pytest.importorskip("pyvista", reason="pyvista reads and writes the files")

FLAVOURS = [(name, binary) for name in ("m.vtk", "m.vtp", "u.vtk", "u.vtu") for binary in (0, 1)]
LEGACY = """# vtk DataFile Version 3.0
A title: POINTS 7 float
ASCII
DATASET POLYDATA
POINTS 6 {kind}
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
VECTORS wind float
0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 7 7 7
"""


def written(folder: Path, name: str = "m.vtp", binary: bool = True) -> Path:
    """Write a sphere with something of each kind."""
    mesh = pv.Sphere(theta_resolution=7, phi_resolution=6).compute_normals(split_vertices=False)
    rng = np.random.default_rng(2)
    mesh.point_data.set_scalars(rng.random(mesh.n_points), "age")
    mesh.point_data["wind"] = rng.random((mesh.n_points, 3))
    mesh.cell_data["part"] = np.arange(mesh.n_cells, dtype=np.int16)
    mesh.field_data["maker"] = ["someone", "else"]
    mesh = mesh.cast_to_unstructured_grid() if name[0] == "u" else mesh
    mesh.save(folder / name, binary=binary)
    return folder / name


def legacy(folder: Path, old: str = "", new: str = "", kind: str = "float") -> Path:
    path = folder / "legacy.vtk"
    assert old in LEGACY
    path.write_text(LEGACY.replace(old, new, 1).format(kind=kind))
    return path


def saved(path: Path, after: np.ndarray[Any, Any]) -> tuple[Any, list[str]]:
    target = path.with_name("saved" + path.suffix)
    warnings = vtk.read(path).save(target, [after])
    return pv.read(target), warnings


@pytest.mark.parametrize(("name", "binary"), FLAVOURS)
def test_a_file_changes_in_its_points_and_normals_only(
    name: str, binary: bool, tmp_path: Path
) -> None:
    path = written(tmp_path, name, binary)
    old, document = pv.read(path), vtk.read(path)
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, old.points)
    np.testing.assert_array_equal(part.quality, old.point_data["age"])
    assert {"point data wind", "cell data part", "field data maker"} < set(document.contents)
    after = part.vertices.copy()
    after[3:] *= [1, 2, 3]
    new, warnings = saved(path, after)
    assert warnings == []
    assert new.points.dtype == np.float32
    np.testing.assert_array_equal(new.points, after.astype(np.float32))
    for arrays in ("point_data", "cell_data", "field_data"):
        before, behind = getattr(old, arrays), getattr(new, arrays)
        assert before.keys() == behind.keys()
        for key in set(before.keys()) - {"Normals"}:
            assert before[key].dtype == behind[key].dtype
            np.testing.assert_array_equal(before[key], behind[key])
    expected = pv.PolyData.from_regular_faces(after, part.faces).compute_normals(
        split_vertices=False, consistent_normals=False
    )
    np.testing.assert_allclose(new.cell_data["Normals"], expected.cell_data["Normals"], atol=1e-6)
    cosines = (new.point_data["Normals"] * expected.point_data["Normals"]).sum(axis=1)
    assert (cosines > 0.8).all()
    if name.endswith(("vtp", "vtu")):
        assert (b'format="ascii"' in (tmp_path / f"saved{path.suffix}").read_bytes()) != binary


def test_a_mesh_that_has_not_moved_gives_an_identical_file(tmp_path: Path) -> None:
    path = legacy(tmp_path)
    saved(path, vtk.read(path).parts[0].vertices)
    assert (tmp_path / "saved.vtk").read_bytes() == path.read_bytes()


@pytest.mark.parametrize("name", ["m.vtk", "m.vtp"])
def test_points_become_double_where_single_precision_holds_no_movement(
    name: str, tmp_path: Path
) -> None:
    path = written(tmp_path, name)
    after = vtk.read(path).parts[0].vertices
    after[1:] += 1e-9
    new, (warning,) = saved(path, after)
    assert "double precision" in warning
    np.testing.assert_array_equal(new.points, after)


def test_points_polygons_and_strips_of_a_legacy_text_keep_all_digits(tmp_path: Path) -> None:
    path = legacy(tmp_path, kind="double")
    document = vtk.read(path)
    (part,) = document.parts
    assert part.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4], [0, 1, 3], [1, 4, 3]]
    assert part.quality is not None
    assert part.quality[0] == 0.1234567890123456
    assert "points and lines" in document.contents
    after = part.vertices.copy()
    after[4, 2] = 1 / 3
    new, _ = saved(path, after)
    np.testing.assert_array_equal(new.points, after)
    np.testing.assert_array_equal(new["age"], part.quality)
    # The vertex and the square have not moved; the triangle's normal stays on its side.
    expected = np.array([[0, 0, 1], [0, 0, 1], [0, -2 / 13**0.5, 3 / 13**0.5]])
    expected[2] = np.sign(expected[2]) * np.abs([0, 1 / 3, 1 / 2]) / np.hypot(1 / 3, 1 / 2)
    np.testing.assert_allclose(new.cell_data["flat"][:3], expected, atol=1e-6)


def test_damaged_files_are_refused_with_what_is_wrong(tmp_path: Path) -> None:
    pass
