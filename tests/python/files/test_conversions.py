"""What MeshLab reads or writes for us: the quality and triangles are those of the file."""

from __future__ import annotations

import locale
import re
import shutil
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
import pyvista
from helpers import filter_file, mesh_set_of
from meshlab_spectral import DenoiseOptions, FilterOptions
from meshlab_spectral.errors import FormatError
from meshlab_spectral.files.filtering import filter_to_scratch
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.whole_files import writing_whole
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement

Array = NDArray[Any]
OPTIONS = {"feature_size": "20%", "weight": "vertex quality"}


def noisy_sphere() -> tuple[Array, Array]:
    sphere = pyvista.Icosphere(nsub=3)
    V = np.asarray(sphere.points, float)
    V *= 1 + np.random.default_rng(2).normal(0, 0.01, (len(V), 1))
    return V.astype("f4").astype(float), np.asarray(sphere.faces).reshape(-1, 4)[:, 1:]


def as_3ds(V: Array, F: Array) -> bytes:
    """Return a mesh as a 3D Studio file: chunks in chunks, each with its kind and size."""

    def chunk(kind: int, *parts: bytes) -> bytes:
        content = b"".join(parts)
        return struct.pack("<HI", kind, 6 + len(content)) + content

    vertices = chunk(0x4110, struct.pack("<H", len(V)), V.astype("<f4").tobytes())
    corners = np.column_stack([F, np.zeros(len(F))]).astype("<u2")  # and flags
    faces = chunk(0x4120, struct.pack("<H", len(F)), corners.tobytes())
    mesh = chunk(0x4000, b"mesh\0", chunk(0x4100, vertices, faces))
    return chunk(0x4D4D, chunk(0x3D3D, mesh))


def write_with_quality(path: Path, name: str, type_: str, text: bool) -> None:
    """Write a PLY file with a quality that rises with z; other properties come between."""
    V, F = noisy_sphere()
    columns = {"label": "u1", "x": "f4", "y": "f4", "z": "f4", name: type_, "time": "f8"}
    vertex = np.zeros(len(V), list(columns.items()))
    vertex["x"], vertex["y"], vertex["z"] = V.T
    vertex[name], vertex["time"] = (V[:, 2] + 1.1) / 2.2, 7.0
    face = np.array([(row,) for row in F], [("vertex_indices", "i4", 3)])
    elements = [PlyElement.describe(vertex, "vertex"), PlyElement.describe(face, "face")]
    PlyData(elements, text=text).write(path)


@pytest.mark.parametrize("text", [False, True])
@pytest.mark.parametrize("type_", ["f4", "f8"])
@pytest.mark.parametrize("name", ["confidence", "quality"])
@pytest.mark.parametrize("ending", [".ply", ".obj", ".off", ".stl"])
def test_the_weight_is_the_quality_of_the_file_whatever_the_output(
    ending: str, name: str, type_: str, text: bool, tmp_path: Path
) -> None:
    source, target = tmp_path / "in.ply", tmp_path / f"out{ending}"
    write_with_quality(source, name, type_, text)
    report = filter_file(source, target, FilterOptions.from_dict(OPTIONS))
    expected = filter_file(source, tmp_path / "expected.ply", FilterOptions.from_dict(OPTIONS))
    assert report["max_displacement"] == pytest.approx(expected["max_displacement"], rel=1e-4)
    assert report["max_displacement"] > 0
    V, _ = load_arrays(tmp_path / "expected.ply")
    W, _ = load_arrays(target)
    order, other = (np.lexsort(np.round(one, 4).T) for one in (V, W))
    np.testing.assert_allclose(V[order], W[other], atol=2e-4)


SCRIPT = """<!DOCTYPE FilterScript><FilterScript><filter name="Per Vertex Quality Function">
<Param name="q" type="RichString" value="q * 2"/>
<Param name="normalize" type="RichBool" value="false"/>
<Param name="onselected" type="RichBool" value="false"/></filter></FilterScript>"""


def test_a_script_gets_the_quality_of_the_file(tmp_path: Path) -> None:
    source, target = tmp_path / "in.ply", tmp_path / "out.ply"
    write_with_quality(source, "confidence", "f4", text=False)
    with writing_whole(target) as scratch:
        filter_to_scratch(Request(source, script=SCRIPT), scratch, lambda *stage: None)
    expected = 2 * PlyData.read(source)["vertex"]["confidence"]
    np.testing.assert_allclose(PlyData.read(target)["vertex"]["quality"], expected, rtol=1e-6)


OUTLINE = ("0 0", "4 0", "4 1", "1 1", "1 4", "0 4")
CAP = "".join(f"v {at} {z}\n" for z in (0, 2) for at in OUTLINE)
SIDES = "".join(f"f {k + 1} {(k + 1) % 6 + 1} {(k + 1) % 6 + 7} {k + 7}\n" for k in range(6))


@pytest.mark.parametrize("ends", [".ply .obj", ".ply .stl", ".off .ply", ".obj .ply", ".obj .off"])
def test_a_conversion_does_not_fold_concave_polygons(ends: str, tmp_path: Path) -> None:
    """MeshLab fans those of PLY and OFF files into triangles that overlap."""
    before, after = ends.split()
    rows = [line.split()[1:] for line in CAP.splitlines()]
    corners = [[4, 3, 2, 1, 0, 5], [10, 11, 6, 7, 8, 9]]
    corners += [[int(word) - 1 for word in line.split()[1:]] for line in SIDES.splitlines()]
    source, target = tmp_path / f"in{before}", tmp_path / f"out{after}"
    vertices = [" ".join(row) for row in rows]
    faces = [f"{len(one)} {' '.join(map(str, one))}" for one in corners]
    if before == ".ply":
        axes = "".join(f"property double {axis}\n" for axis in "xyz")
        head = f"ply\nformat ascii 1.0\nelement vertex 12\n{axes}element face 8\n"
        head += "property list int int vertex_indices\nend_header"
    else:
        head = "OFF\n12 8 0"
    if before == ".obj":
        faces = ["f " + " ".join(str(k + 1) for k in one) for one in corners]
        source.write_text("\n".join([*CAP.splitlines(), *faces, ""]))
    else:
        source.write_text("\n".join([head, *vertices, *faces, ""]))
    filter_file(source, target, FilterOptions.from_dict({"feature_size": "0.01%"}))
    V, F = load_arrays(target)
    areas = np.linalg.norm(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]), axis=1) / 2
    assert areas.sum() == pytest.approx(2 * 7 + 2 * 16, rel=1e-3)


COLLADA = """<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis></asset>
<library_lights><light id="sun" name="sun"><technique_common><directional><color>1 1 1</color>
</directional></technique_common></light></library_lights>
<library_geometries><geometry id="g" name="my part"><mesh>
<source id="p"><float_array id="pa" count="{count}">{points}</float_array><technique_common>
<accessor source="#pa" count="{vertices}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{faces}"><input semantic="VERTEX" source="#v" offset="0"/><p>{corners}</p>
</triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>5 0 0</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def write_collada(path: Path, V: Array, F: Array) -> None:
    words = {"points": V.ravel(), "corners": F.ravel()}
    text = {key: " ".join(f"{x:.9g}" for x in row.tolist()) for key, row in words.items()}
    path.write_text(COLLADA.format(count=V.size, vertices=len(V), faces=len(F), **text))


def test_a_scene_in_which_nothing_moves_is_copied(tmp_path: Path) -> None:
    sphere = pyvista.Icosphere(nsub=3)
    source, target = tmp_path / "in.dae", tmp_path / "out.dae"
    write_collada(source, np.asarray(sphere.points, float), sphere.faces.reshape(-1, 4)[:, 1:])
    report = filter_file(source, target, DenoiseOptions())
    assert report["max_displacement"] == 0
    assert target.read_bytes() == source.read_bytes()
    assert not any("rewritten" in warning for warning in report["warnings"])


@pytest.mark.parametrize("ending", [".dae", ".ply"])
def test_what_a_scene_loses_is_told(ending: str, tmp_path: Path) -> None:
    source, target = tmp_path / "in.dae", tmp_path / f"out{ending}"
    write_collada(source, *noisy_sphere())
    report = filter_file(source, target, FilterOptions.from_dict({"feature_size": "20%"}))
    (loss,) = (warning for warning in report["warnings"] if "rewritten by MeshLab" in warning)
    assert loss.endswith("loses units, transforms, lights, names")


@pytest.mark.parametrize("ending", [".dae", ".3ds", ".x3d", ".wrl", ".ctm"])
def test_every_format_that_only_meshlab_reads_warns_that_it_is_rewritten(
    ending: str, tmp_path: Path
) -> None:
    mesh_set = mesh_set_of(*noisy_sphere())
    source, target = tmp_path / f"in{ending}", tmp_path / f"out{ending}"
    if ending == ".3ds":  # which MeshLab may write in a way that it cannot read
        source.write_bytes(as_3ds(*noisy_sphere()))
    else:
        mesh_set.save_current_mesh(str(source))
    shutil.copyfile(source, tmp_path / "copy")
    report = filter_file(source, target, FilterOptions.from_dict({"feature_size": "20%"}))
    assert any("rewritten by MeshLab" in warning for warning in report["warnings"])


def write_sphere(path: Path, size: float = 1.0, **data: Array) -> None:
    """Write a PLY file with what is given of colours; normals if there are colours."""
    V, F = noisy_sphere()
    mesh_set = pymeshlab.MeshSet(verbose=False)
    mesh_set.add_mesh(pymeshlab.Mesh(size * V, F, **data))
    flags = {"save_vertex_color": "v_color_matrix" in data, "save_vertex_normal": bool(data)}
    flags |= {"save_face_color": "f_color_matrix" in data, "save_vertex_quality": False}
    mesh_set.save_current_mesh(str(path), **flags)


SMOOTH = FilterOptions.from_dict({"feature_size": "20%"})


@pytest.mark.parametrize("ending", [".obj", ".x3d", ".xyz"])
@pytest.mark.parametrize("has_normals", [False, True])
def test_normals_are_of_unit_length_or_none(has_normals: bool, ending: str, tmp_path: Path) -> None:
    colours = {"v_color_matrix": np.full((642, 4), 0.5)} if has_normals else {}
    write_sphere(tmp_path / "in.ply", **colours)
    filter_file(tmp_path / "in.ply", tmp_path / f"out{ending}", SMOOTH)
    text = (tmp_path / f"out{ending}").read_text()
    if ending == ".obj":
        rows = [line.split()[1:] for line in text.splitlines() if line.startswith("vn ")]
    elif ending == ".xyz":
        rows = [line.split()[3:] for line in text.splitlines()]
    else:
        found = re.search(r'<Normal vector="([^"]*)"', text)
        rows = np.reshape(found[1].split(), (-1, 3)).tolist() if found else []
    normals = np.reshape(np.array([row for row in rows if row], float), (-1, 3))
    assert len(normals) == (642 if has_normals else 0)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-4)


def test_off_files_have_no_normals_and_colours_only_if_there_are(tmp_path: Path) -> None:
    """Readers take three numbers, or colours after them."""
    write_sphere(tmp_path / "in.ply")
    filter_file(tmp_path / "in.ply", tmp_path / "out.off", SMOOTH)
    assert (tmp_path / "out.off").read_text().splitlines()[0] == "OFF"
    write_sphere(tmp_path / "in.ply", v_color_matrix=np.full((642, 4), 0.5))
    report = filter_file(tmp_path / "in.ply", tmp_path / "out.off", SMOOTH)
    assert (tmp_path / "out.off").read_text().splitlines()[0] == "COFF"
    assert report["warnings"] == ["out.off loses normals"]


FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])


@pytest.mark.parametrize("source", ["in.ply", "in.vtp"])
def test_stl_files_have_colours_only_if_there_are(source: str, tmp_path: Path) -> None:
    if source == "in.vtp":
        pyvista.PolyData.from_regular_faces(*noisy_sphere()).save(tmp_path / source)
    else:
        write_sphere(tmp_path / source)
    filter_file(tmp_path / source, tmp_path / "out.stl", SMOOTH)
    content = (tmp_path / "out.stl").read_bytes()
    assert b"COLOR=" not in content[:80]
    assert not content.startswith(b"solid")
    assert not np.frombuffer(content, FACET, offset=84)["colour"].any()
    red = np.tile([1.0, 0, 0, 1], (1280, 1))
    write_sphere(tmp_path / "red.ply", f_color_matrix=red)
    report = filter_file(tmp_path / "red.ply", tmp_path / "red.stl", SMOOTH)
    content = (tmp_path / "red.stl").read_bytes()
    assert b"COLOR=\xff\xff\xff\xff" in content[:80]
    assert (np.frombuffer(content, FACET, offset=84)["colour"] == 31).all()  # red is lowest
    assert report["warnings"] == ["red.stl loses normals"]


@pytest.mark.parametrize("size", [1e-5, 1.0])
@pytest.mark.parametrize(
    "ending", [".3mf", ".ctm", ".dae", ".dxf", ".json", ".off", ".obj", ".stl", ".wrl", ".x3d"]
)
def test_a_format_that_rounds_away_the_filter_is_told(
    ending: str, size: float, tmp_path: Path
) -> None:
    write_sphere(tmp_path / "in.ply", size)
    report = filter_file(tmp_path / "in.ply", tmp_path / f"out{ending}", SMOOTH)
    is_coarse = size < 1 and ending in (".3mf", ".dxf")
    assert any("six decimals round coordinates" in w for w in report["warnings"]) == is_coarse
    if ending not in (".dxf", ".json", ".stl", ".x3d"):  # MeshLab reads the vertices in order
        after, _ = load_arrays(tmp_path / f"out{ending}")
        filter_file(tmp_path / "in.ply", tmp_path / "expected.ply", SMOOTH)
        expected, _ = load_arrays(tmp_path / "expected.ply")
        if ending != ".ctm":  # in another order
            error = np.sqrt(np.mean((after - expected) ** 2))
            moved = np.sqrt(np.mean((expected - load_arrays(tmp_path / "in.ply")[0]) ** 2))
            assert (error > 0.01 * moved) == is_coarse


def test_the_locale_of_the_process_stays(tmp_path: Path) -> None:
    write_sphere(tmp_path / "in.ply")
    before = locale.setlocale(locale.LC_ALL)
    filter_file(tmp_path / "in.ply", tmp_path / "out.3mf", SMOOTH)
    assert locale.setlocale(locale.LC_ALL) == before


def test_a_format_that_cannot_be_written_is_not_offered(tmp_path: Path) -> None:
    write_sphere(tmp_path / "in.ply")
    with pytest.raises(FormatError, match="cannot write"):
        filter_file(tmp_path / "in.ply", tmp_path / "out.u3d", SMOOTH)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["in.ply"]
