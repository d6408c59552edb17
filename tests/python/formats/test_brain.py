"""Surfaces of brains, against nibabel's own readers."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import pytest
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.extensions import is_same_format
from meshlab_spectral.files.meshes import load_parts
from meshlab_spectral.formats.brain import read
from meshlab_spectral.formats.names import FREE_SURFER, ending_of
from meshlab_spectral.formats.opening import format_of, open_document
from nibabel import gifti
from nibabel.freesurfer import read_geometry, write_geometry, write_morph_data
from numpy.typing import NDArray

V = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype="f4")
F = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)
STAMP = "created by a test"


def moved(vertices: NDArray[Any]) -> NDArray[Any]:
    return vertices * [1, 2, 3] + [0.5, 0, 0] * (vertices[:, :1] > 0)


@pytest.fixture(params=["ASCII", "B64BIN", "B64GZ"])
def surface(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A GIFTI file with normals, values and metadata."""
    encoding = f"GIFTI_ENCODING_{request.param}"
    arrays = [
        gifti.GiftiDataArray(data, intent=f"NIFTI_INTENT_{intent}", encoding=encoding)
        for data, intent in (
            (V, "POINTSET"),
            (F.astype("i4"), "TRIANGLE"),
            (V, "VECTOR"),
            (V[:, 0], "SHAPE"),
        )
    ]
    image = gifti.GiftiImage(darrays=arrays, meta=gifti.GiftiMetaData({"subject": "test"}))
    path = tmp_path / "lh.pial.surf.gii"
    image.to_filename(path)
    return path


@pytest.fixture
def pial(tmp_path: Path) -> Path:
    """A FreeSurfer surface with the data that follow the triangles."""
    path = tmp_path / "lh.pial"
    volume = {
        "head": np.array([2, 0, 20], dtype="i4"),
        "valid": "1  # volume info valid",
        "filename": "orig.mgz",
        "volume": np.array([256, 256, 256]),
        "voxelsize": np.ones(3),
        "xras": np.array([-1.0, 0, 0]),
        "yras": np.array([0, 0, -1.0]),
        "zras": np.array([0, 1.0, 0]),
        "cras": np.zeros(3),
    }
    write_geometry(path, V, F, create_stamp=STAMP, volume_info=volume)
    return path


def test_a_gifti_surface_is_read_as_it_is_stored(surface: Path) -> None:
    document = read(surface)
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, V)
    np.testing.assert_array_equal(part.faces, F)
    assert document.contents == ["normals", "values at vertices", "metadata"]


def test_points_and_normals_of_gifti_change_and_nothing_else(surface: Path) -> None:
    document = read(surface)
    target = surface.with_name("new.surf.gii")
    (part,) = document.parts
    assert document.save(target, [moved(part.vertices)]) == []
    before: Any = nibabel.load(surface)
    after: Any = nibabel.load(target)
    np.testing.assert_array_equal(after.darrays[0].data, moved(V))
    normals = after.darrays[2].data
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
    for index in (1, 3):
        np.testing.assert_array_equal(after.darrays[index].data, before.darrays[index].data)
    assert dict(after.meta) == dict(before.meta)
    for array, new in zip(before.darrays, after.darrays, strict=True):
        is_text = array.encoding == 1 and array.data.dtype.kind == "f"  # six decimals to nibabel
        assert new.encoding == (2 if is_text else array.encoding)
    assert [a.data.dtype for a in after.darrays] == [a.data.dtype for a in before.darrays]


def test_a_file_in_which_nothing_moves_is_unchanged(surface: Path, pial: Path) -> None:
    for path in (surface, pial):
        document = read(path)
        target = path.with_name(f"new.{path.name}")
        assert document.save(target, [document.parts[0].vertices]) == []
        assert target.read_bytes() == path.read_bytes()


def test_coordinates_of_free_surfer_change_and_nothing_else(pial: Path) -> None:
    document = read(pial)
    target = pial.with_name("new.pial")
    assert document.save(target, [moved(document.parts[0].vertices)]) == []
    vertices, faces, volume, stamp = read_geometry(target, read_metadata=True, read_stamp=True)
    np.testing.assert_array_equal(vertices, moved(V))
    np.testing.assert_array_equal(faces, F)
    assert stamp == STAMP
    assert volume["filename"] == "orig.mgz"
    assert len(target.read_bytes()) == len(pial.read_bytes())
    assert document.contents == ["volume geometry"]


def test_a_movement_lost_in_single_precision_is_a_warning(pial: Path) -> None:
    document = read(pial)
    (warning,) = document.save(pial.with_name("new.pial"), [document.parts[0].vertices + 1e-8])
    assert "single precision" in warning


def test_values_without_a_surface_are_refused_with_the_file_to_pass(tmp_path: Path) -> None:
    path = tmp_path / "lh.thickness.gii"
    values = gifti.GiftiDataArray(V[:, 0], intent="NIFTI_INTENT_SHAPE")
    gifti.GiftiImage(darrays=[values]).to_filename(path)
    with pytest.raises(MeshFileError, match=r"0 sets of points .* name the file with the surface"):
        read(path)
    curvature = tmp_path / "lh.pial"
    curvature.write_bytes(b"\xff\xff\xff" + bytes(24))
    with pytest.raises(MeshFileError, match=r"values of FreeSurfer, not a surface.* lh\.pial"):
        read(curvature)


def test_free_surfers_empty_line_may_be_missing(pial: Path) -> None:
    data = pial.read_bytes().replace(b"\n\n", b"\n", 1)  # as CAT writes it, and FreeSurfer reads
    pial.write_bytes(data)
    document = read(pial)
    np.testing.assert_array_equal(document.parts[0].vertices, V)
    document.save(pial.with_name("same.pial"), [V])
    assert pial.with_name("same.pial").read_bytes() == data


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"\xff\xff\xfe", b"ply"),
        (STAMP.encode(), STAMP.encode() + b"\n\n"),
        (V.astype(">f4").tobytes(), b"\x7f\xc0\0\0" * 18),
        (F.astype(">i4").tobytes(), b"\x7f\0\0\0" * 24),
        (b"\0\0\0\6\0\0\0\10", b"\x7f\0\0\6\0\0\0\10"),
    ],
)
def test_a_damaged_free_surfer_file_is_refused(old: bytes, new: bytes, pial: Path) -> None:
    data = pial.read_bytes()
    assert old in data
    pial.write_bytes(data.replace(old, new))
    with pytest.raises(MeshFileError, match=r"lh\.pial"):
        read(pial)


@pytest.mark.parametrize("part", [0.0, 0.1, 0.5, 0.9])
def test_a_cut_gifti_file_is_refused(part: float, surface: Path) -> None:
    data = surface.read_bytes()
    surface.write_bytes(data[: int(part * len(data))])
    with pytest.raises(MeshFileError) as error:
        read(surface)
    assert error.value.code == ("cut_off" if part else "empty")


def test_xml_that_is_not_gifti_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "picture.gii"
    path.write_text("<svg><g/></svg>")
    with pytest.raises(MeshFileError, match="not GIFTI"):
        read(path)


@pytest.mark.parametrize(
    "name", ["lh.pial.T1", "lh.orig", "rh.white.preaparc", "lh.smoothwm", "lh"]
)
def test_a_surface_of_free_surfer_may_have_any_name(name: str, pial: Path) -> None:
    path = pial.rename(pial.with_name(name))
    assert format_of(path) == FREE_SURFER
    (part,) = open_document(path).parts
    np.testing.assert_array_equal(part.vertices, V)
    assert is_same_format(path, path.with_name("lh.anything"))
    assert not is_same_format(path, path.with_name("lh.ply"))


@pytest.mark.parametrize("magic", [b"\xff\xff\xff", b"\xff\xff\xfd"])
@pytest.mark.parametrize("seed", range(5))
def test_quadrilaterals_of_free_surfer_are_those_that_nibabel_reads(
    seed: int, magic: bytes, tmp_path: Path
) -> None:
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(4, 400)), int(rng.integers(1, 300))
    coordinates = rng.integers(-32768, 32768, (n, 3))
    quads = np.array([rng.permutation(n)[:4] for _ in range(m)])
    number = ">i2" if magic == b"\xff\xff\xff" else ">f4"
    path = tmp_path / "lh.any"
    counts = n.to_bytes(3, "big") + m.to_bytes(3, "big")
    corners = quads.astype(">u4").reshape(-1, 1).view(np.uint8)[:, 1:].tobytes()
    path.write_bytes(magic + counts + coordinates.astype(number).tobytes() + corners)
    points, faces = read_geometry(path)
    document = open_document(path)
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, points)
    np.testing.assert_array_equal(part.faces, faces)
    same, other = tmp_path / "same", tmp_path / "lh.other"
    document.save(same, [part.vertices])
    assert same.read_bytes() == path.read_bytes()
    assert document.save(other, [moved(part.vertices)]) == []
    points, faces = read_geometry(other)
    np.testing.assert_allclose(points, moved(part.vertices), rtol=1e-6)
    np.testing.assert_array_equal(faces, part.faces)
    path.write_bytes(path.read_bytes()[:-5])
    with pytest.raises(
        MeshFileError, match="not a surface" if number == ">i2" else "ends too early"
    ):
        open_document(path)


def test_values_of_free_surfer_are_named(tmp_path: Path) -> None:
    path = tmp_path / "lh.curv"
    write_morph_data(path, np.linspace(-1, 1, 100))
    with pytest.raises(MeshFileError, match="holds values of FreeSurfer, not a surface") as error:
        load_parts(path)
    assert error.value.code == "unsupported"


@pytest.mark.parametrize(
    "endings", [(".gii.gz", ".gii.gz"), (".gii.gz", ".gii"), (".gii", ".gii.gz")]
)
def test_a_compressed_gifti_file_is_one(endings: tuple[str, str], surface: Path) -> None:
    before = read(surface).parts[0].vertices
    source, target = (surface.with_name(f"{k}.surf{e}") for k, e in enumerate(endings))
    content = surface.read_bytes()
    source.write_bytes(gzip.compress(content) if endings[0] == ".gii.gz" else content)
    assert is_same_format(source, target)
    document = open_document(source)
    np.testing.assert_array_equal(document.parts[0].vertices, before)
    for step in (0, 1):  # also where nothing moves
        document.save(target, [before + step])
        after = open_document(target).parts[0].vertices
        np.testing.assert_allclose(after, before + step, atol=1e-6)
        assert (target.read_bytes()[:2] == b"\x1f\x8b") == (endings[1] == ".gii.gz")


def test_numbers_in_a_file_of_their_own_are_read_and_copied_or_written_into_the_file(
    surface: Path, tmp_path: Path
) -> None:
    """As CAT12 writes them; nibabel reads them, and cannot write them."""
    image = nibabel.gifti.GiftiImage.from_filename(surface)
    blob, text = b"", ""
    for array in image.darrays[:2]:
        intent = nibabel.nifti1.intent_codes.niistring[array.intent]
        type_ = nibabel.nifti1.data_type_codes.niistring[array.datatype]
        data = array.data.astype(array.data.dtype.newbyteorder("<"))
        text += (
            f'<DataArray Intent="{intent}" DataType="{type_}" ArrayIndexingOrder="RowMajorOrder" '
            f'Dimensionality="2" Dim0="{data.shape[0]}" Dim1="3" Encoding="ExternalFileBinary" '
            f'Endian="LittleEndian" ExternalFileName="s.dat" ExternalFileOffset="{len(blob)}">'
            "<Data/></DataArray>"
        )
        blob += data.tobytes()
    folder = tmp_path / "external"
    (folder / "out").mkdir(parents=True)
    (folder / "out/scratch").mkdir()
    source, target = folder / "s.gii", tmp_path / "out/s.gii"
    target.parent.mkdir()
    source.write_text(f'<?xml version="1.0"?><GIFTI Version="1.0">{text}</GIFTI>')
    (folder / "s.dat").write_bytes(blob)
    (part,) = read(source).parts
    np.testing.assert_array_equal(part.vertices, read(surface).parts[0].vertices)
    assert read(source).save(target, [part.vertices]) == []
    assert target.read_bytes() == source.read_bytes()
    assert target.with_name("s.dat").read_bytes() == blob
    warnings = read(source).save(target, [part.vertices + 1])
    assert warnings == ["the numbers of s.dat are written into s.gii"]
    target.with_name("s.dat").unlink()
    np.testing.assert_allclose(read(target).parts[0].vertices, part.vertices + 1, atol=1e-6)
    (folder / "s.dat").unlink()
    with pytest.raises(MeshFileError, match=r"s\.dat"):
        read(source)


def test_only_gifti_has_an_ending_of_two_parts() -> None:
    endings = {
        "a.surf.gii.GZ": "gii.GZ",
        "a.ply.gz": "gz",
        "a.gii.ply": "ply",
        "ply": "",
        ".ply": "",
    }
    assert {name: ending_of(name) for name in endings} == endings
