"""Surfaces of brains keep everything but their shape; nibabel reads the results."""

from __future__ import annotations

import re
import struct
import zlib
from base64 import b64encode
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from meshlab_spectral.documents import brain
from meshlab_spectral.errors import MeshFileError
from numpy.typing import NDArray

nibabel = pytest.importorskip("nibabel", reason="nibabel writes the files, and reads the results")
gifti = pytest.importorskip("nibabel.gifti")

FLAVOURS = [
    *product(("ASCII", "B64BIN", "B64GZ"), ("big", "little"), ["RowMajorOrder"]),
    # Not as text, which nibabel writes in rows whatever the order.
    *product(("B64BIN", "B64GZ"), ("big", "little"), ["ColumnMajorOrder"]),
]
TAIL = b"\0\0\0\x02\0\0\0\0\0\0\0\x14valid = 1  # volume info valid\nfilename = ../mri/x.mgz\n"


def octahedron() -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    V = np.vstack([np.eye(3), -np.eye(3)]) * [50, 70, 40]
    F = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    return V.astype(np.float32), np.array(F, dtype=np.int32)


def surface_file(
    folder: Path,
    encoding: str = "B64GZ",
    endian: str = "little",
    order: str = "RowMajorOrder",
    leave_out: str = "",
) -> Path:
    """Write a surface with normals, other vectors, values, labels and two coordinate systems."""
    V, F = octahedron()
    normals = V / np.linalg.norm(V, axis=1)[:, None]
    arrays = {
        "SHAPE": np.arange(len(V), dtype=np.float32) / 3,
        "POINTSET": V,
        "TRIANGLE": F,
        "VECTOR": normals,
        "LABEL": np.arange(len(V), dtype=np.int32) % 2,
    }
    image = gifti.GiftiImage(meta=gifti.GiftiMetaData({"Subject": "<100307>"}))
    for intent, array in arrays.items():
        if intent != leave_out:
            image.add_gifti_data_array(
                gifti.GiftiDataArray(
                    array,
                    intent=f"NIFTI_INTENT_{intent}",
                    encoding=encoding,
                    endian=endian,
                    ordering=order,
                    meta={"Name": f"my {intent}"},
                )
            )
    along = gifti.GiftiDataArray(
        np.roll(normals, 1, axis=1), intent="NIFTI_INTENT_VECTOR", encoding=encoding
    )
    image.add_gifti_data_array(along)
    label = gifti.GiftiLabel(key=1, red=1.0, green=0.0, blue=0.0, alpha=1.0)
    label.label = "V1"
    image.labeltable.labels.append(label)
    path = folder / "lh.surf.gii"
    image.to_filename(path)
    # A second matrix, with more digits than nibabel writes, and a comment.
    matrix = (
        b"<CoordinateSystemTransformMatrix><DataSpace>NIFTI_XFORM_UNKNOWN</DataSpace>"
        b"<TransformedSpace>NIFTI_XFORM_TALAIRACH</TransformedSpace><MatrixData>"
        b"2 0 0 0.123456789 0 2 0 0 0 0 2 0 0 0 0 1</MatrixData>"
        b"</CoordinateSystemTransformMatrix><!-- by hand -->"
    )
    path.write_bytes(path.read_bytes().replace(b"<Data>", matrix + b"<Data>"))
    return path


def outside_data(text: bytes) -> list[bytes]:
    return re.split(rb"<Data>[^<]*</Data>", text)


def free_surfer_file(folder: Path, tail: bytes = TAIL + b"\xff\0unknown tag") -> Path:
    V, F = octahedron()
    path = folder / "lh.pial"
    nibabel.freesurfer.write_geometry(path, V, F, create_stamp="created by Ä on a day")
    path.write_bytes(path.read_bytes() + tail)
    return path


def saved(path: Path, after: NDArray[Any]) -> tuple[Path, list[str]]:
    target = path.with_name("saved." + path.name)
    return target, brain.read(path).save(target, [after])


@pytest.mark.parametrize(("encoding", "endian", "order"), FLAVOURS)
def test_a_gifti_file_of_any_flavour_changes_in_its_points_and_normals_only(
    encoding: str, endian: str, order: str, tmp_path: Path
) -> None:
    path = surface_file(tmp_path, encoding, endian, order)
    document = brain.read(path)
    (part,) = document.parts
    V, F = octahedron()
    np.testing.assert_array_equal(part.vertices, V)
    np.testing.assert_array_equal(part.faces, F)
    assert {"labels", "coordinate systems", "shape data", "label data"} < set(document.contents)

    target, warnings = saved(path, part.vertices)
    assert target.read_bytes() == path.read_bytes()
    after = part.vertices * [1, 1, 2.1]
    target, warnings = saved(path, after)
    assert warnings == []
    assert outside_data(target.read_bytes()) == outside_data(path.read_bytes())
    old, new = nibabel.load(path).darrays, nibabel.load(target).darrays
    np.testing.assert_array_equal(new[1].data, after.astype(np.float32))
    for kept in (0, 2, 4, 5):
        np.testing.assert_array_equal(new[kept].data, old[kept].data)
    # By symmetry the octahedron's normals stay those of its axes.
    np.testing.assert_allclose(new[3].data, np.vstack([np.eye(3), -np.eye(3)]), atol=1e-6)
    sheared = part.vertices + part.vertices[:, [2, 2, 2]] * [0.5, 0, 0]
    turned = nibabel.load(saved(path, sheared)[0]).darrays[3].data
    assert turned[2, 0] < -0.1 or turned[2, 0] > 0.1
    np.testing.assert_allclose(np.linalg.norm(turned, axis=1), 1, atol=1e-6)


def test_the_text_of_a_gifti_file_changes_in_moved_numbers_only(tmp_path: Path) -> None:
    path = surface_file(tmp_path, "ASCII", leave_out="VECTOR")
    after = brain.read(path).parts[0].vertices
    after[4, 1] = -70.5
    target, _ = saved(path, after)
    lines = [data.splitlines() for data in (path.read_bytes(), target.read_bytes())]
    (changed,) = [(a, b) for a, b in zip(*lines, strict=True) if a != b]
    assert changed[0].replace(b"-70.000000", b"-70.5") == changed[1]


def test_a_movement_that_single_precision_does_not_hold_is_told(tmp_path: Path) -> None:
    for path in (surface_file(tmp_path), free_surfer_file(tmp_path)):
        _, (warning,) = saved(path, brain.read(path).parts[0].vertices + 1e-7)
        assert "single precision" in warning


@pytest.mark.parametrize("tail", [b"", TAIL, TAIL + b"\xff\0unknown tag"])
def test_a_free_surfer_file_changes_in_its_coordinates_only(tail: bytes, tmp_path: Path) -> None:
    path = free_surfer_file(tmp_path, tail)
    document = brain.read(path)
    (part,) = document.parts
    V, F = octahedron()
    np.testing.assert_array_equal(part.vertices, V)
    np.testing.assert_array_equal(part.faces, F)
    assert document.contents == (["volume geometry"] if tail else [])
    assert saved(path, part.vertices)[0].read_bytes() == path.read_bytes()
    target, warnings = saved(path, 2.5 * part.vertices)
    assert warnings == []
    coordinates = V.astype(">f4").tobytes()
    doubled = (2.5 * V).astype(">f4").tobytes()
    assert target.read_bytes() == path.read_bytes().replace(coordinates, doubled)
    read_again, faces, stamp = nibabel.freesurfer.read_geometry(target, read_stamp=True)
    np.testing.assert_array_equal(read_again, 2.5 * V)
    np.testing.assert_array_equal(faces, F)
    assert stamp == "created by Ä on a day"


@pytest.mark.parametrize(
    ("leave_out", "message"),
    [("TRIANGLE", "0 arrays of triangles.*surf.gii"), ("POINTSET", "0 arrays of points")],
)
def test_half_a_surface_is_refused(leave_out: str, message: str, tmp_path: Path) -> None:
    path = surface_file(tmp_path, leave_out=leave_out)
    with pytest.raises(MeshFileError, match=message):
        brain.read(path)


@pytest.mark.parametrize("intent", ["TIME_SERIES", "LABEL"])
def test_values_without_a_surface_are_refused_with_what_to_name(
    intent: str, tmp_path: Path
) -> None:
    kind = np.int32 if intent == "LABEL" else np.float32
    array = gifti.GiftiDataArray(np.zeros(5, dtype=kind), intent=f"NIFTI_INTENT_{intent}")
    path = tmp_path / "lh.func.gii"
    gifti.GiftiImage(darrays=[array]).to_filename(path)
    with pytest.raises(MeshFileError, match=rf"no surface.*{intent}.*\.surf\.gii"):
        brain.read(path)


def test_values_of_free_surfer_are_refused_with_what_they_are(tmp_path: Path) -> None:
    path = tmp_path / "lh.curv"
    nibabel.freesurfer.write_morph_data(path, np.zeros(6))
    with pytest.raises(MeshFileError, match=r"values at 6 vertices.*lh\.pial"):
        brain.read(path)


@pytest.mark.parametrize("magic", [b"\xff\xff\xff", b"\xff\xff\xfd"])
def test_quadrilaterals_of_free_surfer_are_refused_with_a_remedy(
    magic: bytes, tmp_path: Path
) -> None:
    path = tmp_path / "lh.quad"
    path.write_bytes(magic + bytes(60))
    with pytest.raises(MeshFileError, match="mris_convert"):
        brain.read(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (struct.pack(">ii", 6, 8), struct.pack(">ii", 2**31 - 1, 8), "2147483647 vertices"),
        (struct.pack(">ii", 6, 8), struct.pack(">ii", 6, -8), "-8 triangles"),
        (struct.pack(">f", 70), struct.pack(">f", np.nan), "vertex 1 is at 0 nan"),
        (struct.pack(">iii", 1, 3, 2), struct.pack(">iii", 1, 3, 6), "face 1 has.*of 6 vertices"),
        (struct.pack(">iii", 0, 4, 5), b"", "6 vertices and 8 triangles, for"),
        (b"\xff\xff\xfe", b"ply", "neither as GIFTI nor"),
    ],
)
def test_a_damaged_free_surfer_file_is_refused_with_what_is_wrong(
    old: bytes, new: bytes, message: str, tmp_path: Path
) -> None:
    path = free_surfer_file(tmp_path, tail=b"")
    data = path.read_bytes()
    assert old in data
    path.write_bytes(data.replace(old, new, 1))
    with pytest.raises(MeshFileError, match=message):
        brain.read(path)


NO_NUMBERS = b64encode(zlib.compress(np.full(18, np.nan, "<f4").tobytes()))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b'Dim0="6" Dim1="3"', b'Dim0="7" Dim1="3"', "do not have the 84 bytes"),
        (b'Dim0="6" Dim1="3"', b'Dim0="9999999999" Dim1="3"', "cannot be"),
        (b'Dim0="6" Dim1="3"', b'Dim0="-6" Dim1="3"', "no n x 3"),
        (b'Dim0="6" Dim1="3"', b'Dim0="many" Dim1="3"', "invalid literal"),
        (b'Dim0="6" Dim1="3"', b'Dim0="6" Dim1="4"', "no n x 3"),
        (b"GZipBase64Binary", b"ExternalFileBinary", "another file.*wb_command"),
        (b"GZipBase64Binary", b"Base64Binary", "multiple"),
        (b"NIFTI_TYPE_FLOAT32", b"NIFTI_TYPE_COMPLEX64", "COMPLEX64"),
        (rb"....</Data>", b"</Data>", "compressed data"),
        (rb".</Data>", b"</Data>", "base64"),
        (rb"<Data>.*</Data>", b"<Data>%s</Data>" % NO_NUMBERS, "vertex 0 is at nan"),
        (b"</GIFTI>", b"", "no element found"),
    ],
)
def test_a_damaged_gifti_file_is_refused_with_what_is_wrong(
    old: bytes, new: bytes, message: str, tmp_path: Path
) -> None:
    path = surface_file(tmp_path)
    data = path.read_bytes()
    begin = data.index(b'Intent="NIFTI_INTENT_POINTSET"')
    damaged, count = re.subn(old, new, data[begin:], count=1)
    assert count
    path.write_bytes(data[:begin] + damaged)
    with pytest.raises(MeshFileError, match=message):
        brain.read(path)


def test_xml_that_is_not_gifti_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "picture.gii"
    path.write_text("<svg/>")
    with pytest.raises(MeshFileError, match="svg, not GIFTI"):
        brain.read(path)


def test_a_file_that_is_cut_off_anywhere_is_refused_or_whole(tmp_path: Path) -> None:
    for path in (surface_file(tmp_path), free_surfer_file(tmp_path, tail=b"")):
        data = path.read_bytes()
        for length in np.random.default_rng(1).integers(len(data), size=60):
            path.write_bytes(data[:length])
            with pytest.raises(MeshFileError, match=re.escape(str(path))):
                brain.read(path)
