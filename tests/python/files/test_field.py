"""Files as users bring them: the result is right, and nothing but coordinates and normals differs.

They lie next to the project; the tests are skipped where they are absent.
"""

from __future__ import annotations

import json
import shutil
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
import pytest
from helpers import filter_file, loaded, mesh_set_of
from meshlab_spectral import DenoiseOptions, FilterOptions
from meshlab_spectral.errors import MeshFileError, OptionError
from meshlab_spectral.files.meshes import load_arrays
from meshlab_spectral.formats.opening import open_document
from numpy.typing import NDArray
from plyfile import PlyData

Field = Callable[[str], Path]
FIELD = Path(__file__).resolve().parents[4] / "shared" / "field"
SMOOTH = FilterOptions.from_dict({"feature_size": "15%"})


@pytest.fixture
def field(tmp_path: Path) -> Field:
    """Return the path of a copy of a file, with the files next to it."""

    def get(name: str) -> Path:
        source = FIELD / name
        if not source.is_file():
            pytest.skip(f"no {name} beside the project")
        folder = tmp_path / "in"
        folder.mkdir(exist_ok=True)
        beside = source.parent.iterdir() if source.parent != FIELD else [source]
        for file in filter(Path.is_file, beside):
            shutil.copyfile(file, folder / file.name)
        return folder / source.name

    return get


@pytest.fixture
def target(tmp_path: Path) -> Callable[[str], Path]:
    (tmp_path / "out").mkdir()
    return lambda name: tmp_path / "out" / name


Target = Callable[[str], Path]


def extent(V: NDArray[Any]) -> NDArray[Any]:
    return np.ptp(V, axis=0)


def json_of(glb: Path) -> dict[str, Any]:
    data = glb.read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    tree: dict[str, Any] = json.loads(data[20 : 20 + size])
    return tree


def without_bounds(tree: dict[str, Any]) -> dict[str, Any]:
    for accessor in tree["accessors"]:
        accessor.pop("min", None)
        accessor.pop("max", None)
    return tree


def model_of(three_mf: Path) -> str:
    with zipfile.ZipFile(three_mf) as archive:
        return archive.read("3D/3dmodel.model").decode()


def test_a_transform_of_a_node_is_applied_and_kept(field: Field, target: Target) -> None:
    source, out = field("node_transform.glb"), target("out.glb")
    V, F = load_arrays(source)
    assert (V[:, 0].min(), V[:, 0].max()) == pytest.approx((4.9, 5.1), abs=2e-3)
    report = filter_file(source, out, SMOOTH)
    expected = mesh_set_of(V, F)
    expected.apply_coord_spectral_filter_fractional(feature_size=pymeshlab.PercentageValue(15))
    placed, _ = load_arrays(out)
    np.testing.assert_allclose(placed, expected.current_mesh().vertex_matrix(), atol=1e-6)
    assert report["max_displacement"] > 1e-4
    assert without_bounds(json_of(out)) == without_bounds(json_of(source))


def test_a_conversion_keeps_the_placement_and_reports_what_is_lost(
    field: Field, target: Target
) -> None:
    source, out = field("node_transform.glb"), target("out.stl")
    report = filter_file(source, out, SMOOTH)
    np.testing.assert_allclose(
        extent(load_arrays(out)[0]), extent(load_arrays(source)[0]), rtol=0.15
    )
    assert any("out.stl loses" in warning for warning in report["warnings"])


@pytest.mark.parametrize("name", ["inch.3mf", "item_transform.3mf"])
def test_units_and_transforms_of_3mf_stay(name: str, field: Field, target: Target) -> None:
    source, out = field(name), target(name)
    filter_file(source, out, SMOOTH)
    before, after = model_of(source), model_of(out)
    assert before != after

    def rest(model: str) -> tuple[str, str]:
        return model[: model.index("<vertices>")], model[model.index("</vertices>") :]

    assert rest(before) == rest(after)
    np.testing.assert_allclose(
        extent(load_arrays(out)[0]), extent(load_arrays(source)[0]), rtol=0.15
    )


def test_a_texture_within_the_file_stays(field: Field, target: Target) -> None:
    source, out = field("embedded_texture.glb"), target("out.glb")
    report = filter_file(source, out, SMOOTH)
    assert report["warnings"] == []
    assert without_bounds(json_of(out)) == without_bounds(json_of(source))
    stl = target("out.stl")
    assert filter_file(source, stl, SMOOTH)["warnings"] != []
    assert stl.is_file()


def test_all_meshes_of_a_file_are_filtered_or_only_a_named_one(
    field: Field, target: Target
) -> None:
    source, out = field("two_meshes.glb"), target("out.glb")
    report = filter_file(source, out, SMOOTH)
    names = [one["mesh"] for one in report["meshes"]]
    before, after = (open_document(path).parts for path in (source, out))
    assert names == [part.name for part in before]
    assert all((a.vertices != b.vertices).any() for a, b in zip(before, after, strict=True))
    one = filter_file(source, out, SMOOTH, mesh=names[1])
    after = open_document(out).parts
    np.testing.assert_array_equal(before[0].vertices, after[0].vertices)
    assert one["max_displacement"] == pytest.approx(report["meshes"][1]["max_displacement"])
    with pytest.raises(OptionError, match=f"choose from {names[0]}, {names[1]}"):
        filter_file(source, out, SMOOTH, mesh="wheel")


def test_nothing_but_coordinates_and_normals_of_a_ply_differs(field: Field, target: Target) -> None:
    source, out = field("extra_properties.ply"), target("out.ply")
    filter_file(source, out, SMOOTH)
    lines, after = (path.read_bytes().splitlines(keepends=True) for path in (source, out))
    body = lines.index(b"end_header\n") + 1
    assert len(lines) == len(after)
    for number, (line, new) in enumerate(zip(lines, after, strict=True)):
        begin = 6 if body <= number < body + 900 else 0
        assert line.split()[begin:] == new.split()[begin:]
        assert begin or line == new
    normals = PlyData.read(out)["vertex"]
    lengths = sum(normals[name].astype(float) ** 2 for name in ("nx", "ny", "nz"))
    np.testing.assert_allclose(lengths, 1, atol=1e-6)


def test_nothing_but_coordinates_and_normals_of_an_obj_differs(
    field: Field, target: Target
) -> None:
    """Its one normal serves faces that turn apart, so that others are added where it stands."""
    source, out = field("obj_materials/model.obj"), target("out.obj")
    report = filter_file(source, out, SMOOTH)
    lines, after = (path.read_bytes().splitlines() for path in (source, out))
    first = next(k for k, line in enumerate(lines) if line[:3] == b"vn ")
    added = len(after) - len(lines)
    assert all(line.split()[:1] == [b"vn"] for line in after[first : first + added + 1])
    for line, new in zip(lines, after[: first + 1] + after[first + added + 1 :], strict=True):
        kind = line.split()[:1]
        if kind in ([b"v"], [b"vn"]):
            assert kind == new.split()[:1]
            assert line.split()[4:] == new.split()[4:]
        elif kind == [b"f"]:
            without = [[word.rpartition(b"/")[0] for word in one.split()] for one in (line, new)]
            assert without[0] == without[1]
        else:
            assert line == new
    N = np.array([line.split()[1:] for line in after if line[:3] == b"vn "], float)
    np.testing.assert_allclose(np.linalg.norm(N, axis=1), 1, atol=1e-6)
    words = [word for line in after if line[:2] == b"f " for word in line.split()[1:]]
    assert {int(word.rpartition(b"/")[2]) for word in words} == {*range(1, len(N) + 1)}
    added_text = f"{added} normals are added, as others serve faces that turn apart"
    for name in ("model.mtl", "my tex a.png", "b.png"):
        assert (out.parent / name).read_bytes() == (source.parent / name).read_bytes()
    missing = "bump.png, which model.obj refers to, is missing"
    assert report["warnings"] == [added_text, missing]


@pytest.mark.parametrize("name", ["uv_seam_split.ply", "triangle_soup.ply"])
@pytest.mark.parametrize("options", [SMOOTH, DenoiseOptions()], ids=["filter", "denoise"])
def test_a_cut_surface_stays_closed(
    name: str, options: FilterOptions | DenoiseOptions, field: Field, target: Target
) -> None:
    source, out = field(name), target("out.ply")
    report = filter_file(source, out, options)
    before, after = (load_arrays(path)[0] for path in (source, out))
    assert report["components"] == 1
    assert report["joined_vertices"] == len(before) - len(np.unique(before, axis=0))
    assert len(np.unique(after, axis=0)) == len(np.unique(before, axis=0))
    assert PlyData.read(out)["vertex"].dtype() == PlyData.read(source)["vertex"].dtype()


def test_the_patch_of_a_closed_hole_is_reported_as_all_that_moves(
    field: Field, target: Target
) -> None:
    mesh_set = loaded(field("hole_in_noisy_sphere.ply"))
    mesh_set.meshing_close_holes()
    mesh_set.apply_coord_spectral_filter_fractional()
    from meshlab_spectral.plugin.library import last_warnings

    assert any(warning.startswith("only the selection: ") for warning in last_warnings())


def test_coordinates_far_from_the_origin_keep_their_digits_or_the_loss_is_reported(
    field: Field, target: Target
) -> None:
    source, out, stl = field("utm_tile.obj"), target("out.obj"), target("out.stl")
    report = filter_file(source, out, DenoiseOptions())
    assert not any("precision" in warning for warning in report["warnings"])
    W, _ = load_arrays(out)
    assert len(np.unique(W[:, 2])) > 1500
    warnings = filter_file(source, stl, SMOOTH)["warnings"]
    assert any("single precision rounds coordinates near 5.12" in warning for warning in warnings)


@pytest.mark.parametrize("name", ["segmentation_staircase.ply", "spikes.ply"])
def test_scanner_noise_is_removed_and_the_types_stay(
    name: str, field: Field, target: Target
) -> None:
    source, out = field(name), target(name)
    report = filter_file(source, out, DenoiseOptions())
    assert report["max_displacement"] > 0
    before, after = (PlyData.read(path) for path in (source, out))
    assert before["vertex"].dtype() == after["vertex"].dtype()
    assert before.header.splitlines() == after.header.splitlines()


def test_an_stl_whose_corners_differ_in_the_last_bits_is_one_surface(
    field: Field, target: Target
) -> None:
    source, out = field("stl_loose1e-08.stl"), target("out.stl")
    report = filter_file(source, out, SMOOTH)
    before, _ = load_arrays(source)
    after, faces = load_arrays(out)
    assert report["components"] == 1
    assert report["joined_vertices"] == len(before) - 2562
    assert (len(after), len(faces)) == (2562, 5120)
    assert report["area_after"] > 0.8 * report["area_before"]


@pytest.mark.parametrize("options", [SMOOTH, DenoiseOptions()], ids=["filter", "denoise"])
def test_meshes_and_primitives_of_one_shape_are_filtered_alike(
    options: FilterOptions | DenoiseOptions, field: Field, target: Target
) -> None:
    shapes = []
    for name in ("g_cut_meshes.glb", "g_cut_prims.glb"):
        report = filter_file(field(name), target(name), options)
        assert report["components"] == 1
        shapes.append(load_arrays(target(name))[0])
    first, second = (one[np.lexsort(np.round(one, 5).T)] for one in shapes)
    np.testing.assert_allclose(first, second, atol=1e-4)


@pytest.mark.parametrize(
    "name",
    ["off_modelnet.off", "obj_continuation.obj", "lh.white", "lh.pial.T1", "gii_ext.surf.gii"],
)
def test_valid_files_that_few_programs_read_are_filtered(
    name: str, field: Field, target: Target
) -> None:
    source, out = field(name), target(name)
    if name == "gii_ext.surf.gii":
        field("gii_ext.dat")
    report = filter_file(source, out, SMOOTH)
    (V, F), (W, G) = load_arrays(source), load_arrays(out)
    assert report["components"] == 1
    assert report["max_displacement"] == pytest.approx(
        np.linalg.norm(W - V, axis=1).max(), rel=1e-3
    )
    np.testing.assert_array_equal(F, G)


def test_decimal_commas_are_called_so(field: Field) -> None:
    with pytest.raises(MeshFileError, match="has decimal commas") as error:
        load_arrays(field("obj_comma.obj"))
    assert error.value.code == "decimal_commas"


def test_materials_with_backslashes_are_found(field: Field, target: Target) -> None:
    source = field("windows_paths/scan.obj")
    shutil.copytree(FIELD / "windows_paths" / "textures", source.parent / "textures")
    out = target("scan.obj")
    (warning,) = filter_file(source, out, SMOOTH)["warnings"]
    assert warning.startswith("C:/Users")
    assert (out.parent / "a.mtl").is_file()
    assert (out.parent / "textures" / "t.png").is_file()
