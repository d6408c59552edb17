"""A refusal names its cause, which is true: every reader with whole, damaged and foreign files.

The causes are those of `MeshFileError.code`.
"""

from __future__ import annotations

import gzip
import re
import zipfile
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import pyvista
from format_samples import SAMPLES, Sample
from hypothesis import given, settings
from hypothesis import strategies as st
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.meshes import load_parts
from meshlab_spectral.formats.opening import open_document
from meshlab_spectral.formats.table import FORMATS

# Without .usd, which is .usda or .usdc, and packed GIFTI, which is gzip.
ENDINGS = [ending for ending in FORMATS if FORMATS[ending].is_patched] + ["pial"]
ENDINGS = [one for one in ENDINGS if one not in ("usd", "gii.gz")]
ENDINGS = [one for one in ENDINGS if not one.startswith("usd") or find_spec("pxr")]
# Formats that each other's readers read, too.
ALIKE = [{"gltf", "glb"}, {"gii", "pial"}]
TEXTS = ["in.ply", "in.obj", "in.off", "in.stl", "in.gltf", "text.vtk", "in.surf.gii"]


def archive(name: str = "readme.txt") -> bytes:
    file = BytesIO()
    with zipfile.ZipFile(file, "w") as zipped:
        zipped.writestr(name, "a scan")
    return file.getvalue()


OUTSIDERS = {
    "a web page": b"<!DOCTYPE html>\n<html><head><title>404</title></head></html>",
    "Git LFS": b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a21\nsize 12345\n",
    "a ZIP archive": archive(),
    "gzip": gzip.compress(b"ply\n" * 100),
    "a PNG image": b"\x89PNG\r\n\x1a\n" + bytes(200),
    "a PDF document": b"%PDF-1.7\n" + b"1 0 obj\n" * 50,
    "a file of zeros": bytes(4000),
    "MNI": b"P 0.3 0.3 0.4 10 1 4\n 0 0 0\n 1 0 0\n 0 1 0\n 0 0 1\n\n"
    b" 0 0 1\n 0 0 1\n 0 0 1\n 0 0 1\n\n 2\n 0 1 1 1 1\n\n 3 6\n\n 0 1 2 0 2 3\n",
    "COLLADA": b'<?xml version="1.0"?>\n<COLLADA version="1.4.1"></COLLADA>\n',
    "is not": b"Dear all,\nplease find the scan attached.\n" * 5,
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A file of each format and kind, by name."""
    paths: dict[str, Path] = {}
    for sample in SAMPLES:
        folder = tmp_path_factory.mktemp("whole")
        sample.write(folder / sample.name)
        name = sample.name if sample.name not in paths else f"binary{Path(sample.name).suffix}"
        paths[name] = folder / sample.name
    folder = tmp_path_factory.mktemp("vtk")
    sphere = pyvista.Icosphere(nsub=2)
    paths["in.vtu"] = folder / "in.vtu"
    sphere.cast_to_unstructured_grid().save(paths["in.vtu"])
    return paths


def refused(path: Path) -> MeshFileError:
    with pytest.raises(MeshFileError) as error:
        load_parts(path)
    assert error.value.code
    assert str(path) in str(error.value)
    return error.value


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.name)
def test_a_whole_file_is_read(sample: Sample, tmp_path: Path) -> None:
    sample.write(tmp_path / sample.name)
    assert load_parts(tmp_path / sample.name)


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_file_under_the_name_of_another_format_is_named(
    ending: str, whole: dict[str, Path], tmp_path: Path
) -> None:
    for name, path in whole.items():
        own = path.name.partition(".")[2].removeprefix("surf.")
        if own == ending or any({own, ending} <= alike for alike in ALIKE):
            continue
        copy = tmp_path / f"renamed.{ending}"
        copy.write_bytes(path.read_bytes())
        error = refused(copy)
        assert error.code == "foreign", f"{name} as .{ending}: {error}"
        if name != "binary.stl":  # binary STL has no mark of its own
            assert re.search(r" is (?!not)", str(error)), f"{name} as .{ending}: {error}"


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("what", OUTSIDERS)
def test_what_is_no_mesh_is_named(what: str, ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"scan.{ending}"
    path.write_bytes(OUTSIDERS[what])
    error = refused(path)
    assert error.code == "foreign"
    assert what in str(error)


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("content", [b"", b" \r\n\n"])
def test_an_empty_file_is_called_so(content: bytes, ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"scan.{ending}"
    path.write_bytes(content)
    assert refused(path).code == "empty"


@pytest.mark.parametrize("ending", ["dae", "x3d", "3ds", "wrl"])
def test_a_file_without_a_byte_is_called_empty_where_meshlab_reads_it(
    ending: str, tmp_path: Path
) -> None:
    path = tmp_path / f"scan.{ending}"
    path.touch()
    assert refused(path).code == "empty"


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_text_in_utf_16_is_called_so(
    encoding: str, name: str, whole: dict[str, Path], tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_text(whole[name].read_text(errors="replace"), encoding=encoding)
    error = refused(path)
    assert error.code == "encoding"
    assert "UTF-16: save it in UTF-8" in str(error)


@pytest.mark.parametrize("name", ["in.ply", "in.obj", "in.off", "in.stl", "in.gltf"])
def test_a_byte_order_mark_of_utf_8_does_not_count(
    name: str, whole: dict[str, Path], tmp_path: Path
) -> None:
    path = whole[name].with_name(f"marked.{name}")
    path.write_bytes(b"\xef\xbb\xbf" + whole[name].read_bytes())
    (part,), (expected,) = load_parts(path), load_parts(whole[name])
    np.testing.assert_array_equal(part.vertices, expected.vertices)
    np.testing.assert_array_equal(part.faces, expected.faces)
    document = open_document(path)
    document.save(tmp_path / name, [part.vertices])
    assert (tmp_path / name).read_bytes() == path.read_bytes()


@pytest.mark.parametrize("name", ["in.ply", "in.obj", "in.off", "in.stl"])
def test_decimal_commas_are_called_so(name: str, whole: dict[str, Path], tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text(re.sub(r"(\d)\.(\d)", r"\1,\2", whole[name].read_text()))
    assert refused(path).code == "decimal_commas"


@pytest.mark.parametrize("share", np.linspace(0.03, 0.97, 12))
def test_a_file_that_is_cut_off_is_called_so(
    share: float, whole: dict[str, Path], tmp_path: Path
) -> None:
    """Or it is read as far as it goes, where nothing tells that there was more."""
    for name, path in whole.items():
        data = path.read_bytes()
        copy = tmp_path / name
        copy.write_bytes(data[: int(share * len(data))])
        for side in path.parent.iterdir():
            if side != path and side.is_file():
                (tmp_path / side.name).write_bytes(side.read_bytes())
        if path.suffix == ".obj":  # which has neither counts nor an end
            continue
        error = refused(copy)
        assert error.code == "cut_off", f"{name}, {share:.0%}: {error}"


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_a_damaged_file_is_not_called_anything_else(
    whole: dict[str, Path], data: st.DataObject
) -> None:
    """The first bytes are as they were, and the length is."""
    name = data.draw(st.sampled_from([one for one in whole if "vt" not in one]))
    content = bytearray(whole[name].read_bytes())
    at = data.draw(st.integers(min(600, len(content) // 4), len(content) * 3 // 4))
    content[at : at + 8] = data.draw(st.binary(min_size=8, max_size=8))
    path = whole[name].with_name(f"damaged.{name}")
    path.write_bytes(content)
    error = error_of(path)
    may_be_cut = error is not None and "cut off or is damaged" in str(error)
    is_called_so = error is None or error.code in ("damaged", "bad_values", "unsupported")
    assert is_called_so or may_be_cut, f"{name}: {error}"


def error_of(path: Path) -> MeshFileError | None:
    try:
        open_document(path)
    except MeshFileError as error:
        return error
    return None
