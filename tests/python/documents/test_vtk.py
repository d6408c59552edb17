"""VTK files keep everything but coordinates and normals; VTK itself reads the results."""

from __future__ import annotations

import re
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from meshlab_spectral.documents import vtk
from meshlab_spectral.errors import MeshFileError

pv = pytest.importorskip("pyvista", reason="pyvista writes the files, and reads the results")

LEGACY = [f"{kind} {v} {t}" for kind, v, t in product("pu", (42, 51), ("ascii", "binary"))]
XML = [
    f"{kind} {mode} {compressor} {word} {order}"
    for kind, mode, (compressor, word, order) in product(
        "pu",
        ("Ascii", "Binary", "Appended", "raw"),
        (("None", 32, "Little"), ("ZLib", 64, "Little"), ("ZLib", 32, "Big"), ("None", 64, "Big")),
    )
]
EVERYTHING = """# vtk DataFile Version 3.0
A title: POINTS 7 float
ASCII
DATASET POLYDATA
FIELD FieldData 2
time%20step 1 1 double
0.1234567890123456
maker 1 2 string
POINTS%20of
someone else
POINTS 6 {kind}
0 0 0   1 0 0
1.00000 1 0.0
0 1 0 0.5 0.5 1e0\t2 2 2
METADATA
INFORMATION 1
NAME L2_NORM_RANGE LOCATION vtkDataArray
DATA 2 0 1.4142135623730951

TRIANGLE_STRIPS 1 5
4 0 1 3 4
VERTICES 1 2
1 4
LINES 1 3
2 0 1
POLYGONS 2 9
4 0 1 2 3
3 0 1 4
CELL_DATA 5
SCALARS part int 1
LOOKUP_TABLE default
1 2 3 4 5
NORMALS flat float
0 0 1 0 0 1 0 0 1 0 0 1 0 0 1
POINT_DATA 6
SCALARS age double
LOOKUP_TABLE mine
0.1234567890123456 2 3 4 5 6
LOOKUP_TABLE mine 2
0 0 0 1 1 1 1 1
COLOR_SCALARS rgb 3
0 0 0 1 1 1 .5 .5 .5 .2 .2 .2 .1 .1 .1 1 1 1
VECTORS wind float
0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 7 7 7
NORMALS smooth float
0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1
TEXTURE_COORDINATES uv 2 float
0 0 0 1 1 1 1 0 .123456789 .5 0 0
FIELD FieldData 1
number 1 6 int
1 2 3 4 5 6
"""


def sphere() -> Any:
    """Make a small surface with something of each kind."""
    mesh = pv.Sphere(theta_resolution=7, phi_resolution=6)
    mesh = mesh.compute_normals(split_vertices=False)
    rng = np.random.default_rng(2)
    mesh.point_data.set_scalars(rng.random(mesh.n_points), "age")
    mesh.point_data["wind"] = rng.random((mesh.n_points, 3))
    mesh.cell_data["part"] = np.arange(mesh.n_cells, dtype=np.int16)
    mesh.field_data["time"] = [1 / 3]
    mesh.field_data["maker"] = ["someone", "else"]
    return mesh


def written(folder: Path, mesh: Any, flavour: str) -> Path:
    """Write a mesh with VTK, in one of the flavours of its formats."""
    kind, mode, *rest = flavour.split()
    name = "PolyData" if kind == "p" else "UnstructuredGrid"
    mesh = mesh if kind == "p" else mesh.cast_to_unstructured_grid()
    if mode.isdigit():
        from vtkmodules import vtkIOLegacy

        path = folder / "mesh.vtk"
        writer = getattr(vtkIOLegacy, f"vtk{name}Writer")()
        writer.SetFileVersion(int(mode))
        writer.SetFileType(1 if rest == ["ascii"] else 2)
    else:
        from vtkmodules import vtkIOXML

        compressor, word, order = rest
        path = folder / f"mesh.vt{kind}"
        writer = getattr(vtkIOXML, f"vtkXML{name}Writer")()
        getattr(writer, f"SetDataModeTo{mode.replace('raw', 'Appended')}")()
        writer.SetEncodeAppendedData(mode != "raw")
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
        getattr(writer, f"SetHeaderTypeToUInt{word}")()
        getattr(writer, f"SetByteOrderTo{order}Endian")()
        writer.SetBlockSize(256)  # several blocks
    writer.SetFileName(str(path))
    writer.SetInputData(mesh)
    assert writer.Write()
    return path


def everything(folder: Path, kind: str = "float") -> Path:
    path = folder / "everything.vtk"
    path.write_bytes(EVERYTHING.format(kind=kind).encode())
    return path


def saved(path: Path, after: np.ndarray[Any, Any]) -> tuple[Path, list[str]]:
    target = path.with_name("saved" + path.suffix)
    return target, vtk.read(path).save(target, [after])


def stretched(vertices: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Move all vertices but the first three."""
    after = vertices.copy()
    after[3:] *= [1, 2, 3]
    return after


def same_but(before: Any, after: Any, *names: str) -> None:
    """Assert that all arrays are the same, but those with `names`."""
    for arrays in ("point_data", "cell_data", "field_data"):
        old, new = getattr(before, arrays), getattr(after, arrays)
        assert old.keys() == new.keys()
        for name in set(old.keys()) - set(names):
            assert old[name].dtype == new[name].dtype
            np.testing.assert_array_equal(old[name], new[name], err_msg=name)


@pytest.mark.parametrize("flavour", LEGACY + XML)
def test_a_file_of_any_flavour_changes_in_its_points_and_normals_only(
    flavour: str, tmp_path: Path
) -> None:
    mesh = sphere()
    path = written(tmp_path, mesh, flavour)
    document = vtk.read(path)
    (part,) = document.parts
    np.testing.assert_allclose(part.vertices, mesh.points, atol=1e-6)
    np.testing.assert_array_equal(part.faces, mesh.regular_faces)
    assert part.quality is not None
    np.testing.assert_allclose(part.quality, mesh.point_data["age"], atol=1e-10)
    assert {"point data wind", "cell data part", "field data maker"} < set(document.contents)

    target, warnings = saved(path, part.vertices)
    assert target.read_bytes() == path.read_bytes()
    after = stretched(part.vertices)
    target, warnings = saved(path, after)
    assert warnings == []
    old, new = pv.read(path), pv.read(target)
    assert new.points.dtype == np.float32
    np.testing.assert_array_equal(new.points, after.astype(np.float32))
    same_but(old, new, "Normals")
    expected = pv.PolyData.from_regular_faces(after, part.faces).compute_normals(
        split_vertices=False, consistent_normals=False
    )
    np.testing.assert_allclose(
        new.cell_data["Normals"], expected.cell_data["Normals"], rtol=0, atol=1e-6
    )
    normals = new.point_data["Normals"]
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
    assert (np.einsum("ij,ij->i", normals, expected.point_data["Normals"]) > 0.8).all()


@pytest.mark.parametrize("flavour", LEGACY + XML)
def test_points_become_double_where_single_precision_holds_no_movement(
    flavour: str, tmp_path: Path
) -> None:
    path = written(tmp_path, sphere(), flavour)
    vertices = vtk.read(path).parts[0].vertices
    after = vertices + 1e-9 * np.random.default_rng(1).normal(size=vertices.shape)
    target, (warning,) = saved(path, after)
    assert "double precision" in warning
    new = pv.read(target)
    assert new.points.dtype == np.float64
    np.testing.assert_allclose(new.points, after, rtol=0, atol=1e-16)
    same_but(pv.read(path), new, "Normals")


def test_the_text_of_a_legacy_file_changes_in_moved_numbers_only(tmp_path: Path) -> None:
    path = everything(tmp_path)
    after = vtk.read(path).parts[0].vertices
    after[4] = [0.25, 0.5, 2]
    target, warnings = saved(path, after)
    assert warnings == []
    old, new = path.read_text().splitlines(), target.read_text().splitlines()
    changed = [(a, b) for a, b in zip(old, new, strict=True) if a != b]
    assert changed[0] == ("0 1 0 0.5 0.5 1e0\t2 2 2", "0 1 0 0.25 0.5 2\t2 2 2")
    assert changed[1][1].startswith("DATA 2 0 3.46")  # the range of the points' lengths
    assert [old[old.index(a) - 1] for a, _ in changed[2:]] == [
        "NORMALS flat float",
        "NORMALS smooth float",
    ]
    # The quadrilateral, the third cell, has not moved; nor has the last point.
    assert changed[2][1].split()[6:9] == ["0", "0", "1"]
    assert changed[3][1].split()[-3:] == ["0", "0", "1"]


def test_all_kinds_of_cells_and_data_are_read(tmp_path: Path) -> None:
    document = vtk.read(everything(tmp_path))
    (part,) = document.parts
    assert part.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4], [0, 1, 3], [1, 4, 3]]
    assert part.quality is not None
    assert part.quality.tolist() == [0.1234567890123456, 2, 3, 4, 5, 6]
    assert document.contents == [
        "field data time step",
        "field data maker",
        *("cell data part", "cell data flat"),
        *(f"point data {name}" for name in ("age", "rgb", "wind", "smooth", "uv", "number")),
        *("points", "lines", "strips", "polygons"),
    ]


def test_no_quality_is_taken_from_colours(tmp_path: Path) -> None:
    path = everything(tmp_path)
    text = path.read_text()
    begin, end = text.index("SCALARS age"), text.index("COLOR_SCALARS")
    path.write_text(text[:begin] + text[end:] + text[begin:end])
    assert vtk.read(path).parts[0].quality is None


def test_a_number_of_an_array_that_is_double_gets_the_digits_it_needs(tmp_path: Path) -> None:
    path = everything(tmp_path, kind="double")
    after = vtk.read(path).parts[0].vertices
    after[2, 1] += 1e-12
    target, warnings = saved(path, after)
    assert warnings == []
    assert vtk.read(target).parts[0].vertices[2, 1] == after[2, 1]
    assert re.search(rb"\n1\.00000 1\.000000000001\d+ 0\.0\n", target.read_bytes())


def test_integer_points_become_real(tmp_path: Path) -> None:
    path = tmp_path / "integers.vtk"
    path.write_text(
        "# vtk DataFile Version 2.0\n\nASCII\nDATASET POLYDATA\nPOINTS 3 int\n0 0 0 1 0 0 0 1 0\n"
        "POLYGONS 1 4\n3 0 1 2\n"
    )
    target, warnings = saved(path, vtk.read(path).parts[0].vertices * 1.5)
    assert warnings == []
    assert "POINTS 3 float\n0 0 0 1.5 0 0 0 1.5 0\n" in target.read_text()


def test_hard_edges_stay_hard(tmp_path: Path) -> None:
    cube = pv.Cube().compute_normals(cell_normals=False, split_vertices=True)
    assert cube.n_points == 24
    path = tmp_path / "cube.vtp"
    cube.save(path)
    part = vtk.read(path).parts[0]
    assert "polygons" in vtk.read(path).contents
    sheared = part.vertices + part.vertices[:, [2, 2, 2]] * [0.5, 0, 0]
    normals = pv.read(saved(path, sheared)[0]).point_data["Normals"]
    corners = sheared[part.faces]
    expected = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    expected /= np.linalg.norm(expected, axis=1)[:, None]
    for corner in range(3):
        np.testing.assert_allclose(normals[part.faces[:, corner]], expected, atol=1e-6)


def test_the_stored_ranges_of_xml_arrays_follow(tmp_path: Path) -> None:
    path = written(tmp_path, sphere(), "p Ascii None 32 Little")
    after = 10 * vtk.read(path).parts[0].vertices
    lengths = np.linalg.norm(after, axis=1)
    text = saved(path, after)[0].read_text()
    array = text[text.index('Name="Points"') : text.index("</Points>")]
    for least, largest in (
        re.findall(r'RangeM..="([^"]*)"', array),
        re.findall(r'<Value index="[01]">\s*(\S*)\s*</Value>', array),
    ):
        assert float(least) == pytest.approx(lengths.min())
        assert float(largest) == pytest.approx(lengths.max())


def test_the_text_around_an_xml_array_stays(tmp_path: Path) -> None:
    path = written(tmp_path, sphere(), "p raw ZLib 32 Little")
    data = path.read_bytes().replace(b"<PolyData>", b"<PolyData><!-- by hand --> ", 1)
    path.write_bytes(data)
    target, _ = saved(path, stretched(vtk.read(path).parts[0].vertices))
    new = target.read_bytes()

    def frame(text: bytes) -> bytes:
        head = text[: text.index(b"<AppendedData")]
        return re.sub(rb'(Range\w+|offset)="[^"]*"|<Value.*\n.*\n', b"", head)

    assert frame(new) == frame(data)
    assert b"by hand" in new


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("# vtk", "vtk", "first lines"),
        ("ASCII", "ASKII", "first lines"),
        ("POINTS 6", "POINTS 99999999999999", "ends before"),
        ("POINTS 6", "POINTS -6", "-18 numbers"),
        ("POINTS 6", "POINTS 5", "no section"),
        ("{kind}", "colour", "no type"),
        ("1.00000", "1.0.0", "could not convert"),
        ("1.00000", "nan", "vertex 2 is at nan"),
        ("1.00000", "1e300", "vertex 2 is at inf"),
        ("4 0 1 2 3", "4 0 1 2 6", "point 6, of 6"),
        ("4 0 1 2 3", "4 0 1 -2 3", "point -2, of 6"),
        ("4 0 1 2 3", "-1 0 1 2 3", "not those of 2 cells"),
        ("4 0 1 2 3", "4000000000 1 2 3 4", "not those of 2 cells"),
        ("POLYGONS 2 9", "POLYGONS 2 999999999", "ends before"),
        ("POINT_DATA 6", "POINT_DATA 5", "missing at"),
        ("FIELD FieldData 2", "FIELD FieldData 999999999", "missing at"),
        ("maker 1 2 string", "maker 1 999999999 string", "ends before"),
        ("SCALARS age double", "SCALARS age double x", "invalid literal"),
        ("DATASET POLYDATA", "DATASET STRUCTURED_GRID", "STRUCTURED_GRID.*Extract Surface"),
    ],
)
def test_a_damaged_legacy_file_is_refused_with_what_is_wrong(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    assert old in EVERYTHING
    path = tmp_path / "damaged.vtk"
    path.write_text(EVERYTHING.replace(old, new, 1).format(kind="float"))
    with pytest.raises(MeshFileError, match=message):
        vtk.read(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('NumberOfPoints="30"', 'NumberOfPoints="99999999999"', "30 points of 99999999999"),
        ('NumberOfPoints="30"', 'NumberOfPoints="many"', "invalid literal"),
        ('"offsets"', '"onsets"', "no offsets"),
        ('type="Float32" Name="Points"', 'type="Float16" Name="Points"', 'type "Float16"'),
        ('type="Float32" Name="Points"', 'type="Float64" Name="Points"', "15 points of 30"),
        ("<Points>", "<Spots>", "mismatched tag"),
        ('version="1.0"', 'version="1.0" encoding="UTF-99"', "unknown encoding"),
        ("<VTKFile", '<!DOCTYPE x [<!ENTITY a "b">]><VTKFile', "entity"),
        ("vtkZLibDataCompressor", "vtkLZ4DataCompressor", "LZ4.*save it with"),
        ('type="PolyData"', 'type="ImageData"', "ImageData.*Extract Surface"),
        ("</PolyData>", "<Piece/></PolyData>", "2 pieces.*Merge"),
        ("AgAAAAAB", "/////wAB", "cut off"),
        ("AABoAAAA", "AH9oAAAA", "compressed bytes cannot be"),
        ("AgAAAAAB", "AgAAAAA", "in the array"),
    ],
)
def test_a_damaged_xml_file_is_refused_with_what_is_wrong(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    path = written(tmp_path, sphere(), "p Binary ZLib 32 Little")
    text = path.read_text()
    begin = text.index("<Points>") if old.startswith("A") else 0
    assert old in text[begin:]
    path.write_text(text[:begin] + text[begin:].replace(old, new, 1))
    with pytest.raises(MeshFileError, match=message):
        vtk.read(path)


@pytest.mark.parametrize(
    "flavour", [*LEGACY, *(f for f in XML if "ZLib 32" in f or "None 64" in f)]
)
def test_a_file_that_is_cut_off_anywhere_is_refused_or_whole(flavour: str, tmp_path: Path) -> None:
    path = written(tmp_path, sphere(), flavour)
    data = path.read_bytes()
    whole = vtk.read(path).parts[0]
    for length in np.random.default_rng(3).integers(len(data), size=25):
        path.write_bytes(data[:length])
        try:
            part = vtk.read(path).parts[0]
        except MeshFileError:
            continue
        assert path.suffix == ".vtk"  # where only what follows the mesh is missing
        np.testing.assert_array_equal(part.vertices, whole.vertices)


def test_data_that_unpack_to_more_than_they_can_are_not_unpacked(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="cannot be"):
        vtk.unzipped(b"x" * 100, 1 << 40)


def test_volume_cells_are_refused_with_a_remedy(tmp_path: Path) -> None:
    grid = pv.UnstructuredGrid({pv.CellType.TETRA: np.array([[0, 1, 2, 3]])}, np.eye(4, 3))
    for name in ("volume.vtu", "volume.vtk"):
        grid.save(tmp_path / name)
        with pytest.raises(MeshFileError, match=r"type 10.*Extract Surface"):
            vtk.read(tmp_path / name)
