"""3MF: the digits of vertices are replaced, and every other byte of the models stays."""

from __future__ import annotations

import re
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats import budget
from meshlab_spectral.formats.document import Document
from meshlab_spectral.formats.three_mf import read
from numpy.typing import NDArray

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
RELATIONSHIPS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Id="a" Target="/Metadata/thumbnail.png" Type="http://x/metadata/thumbnail"/>'
    '<Relationship Id="b" Target="/3D/3dmodel.model" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
ROOT = "3D/3dmodel.model"

POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]  # of a tetrahedron, outwards
MESH = (
    "<mesh><vertices>\n"
    + "".join(f'  <vertex x="{x}.50" y="{y}.00" z="{z}"/>\n' for x, y, z in POINTS)
    + "</vertices>\n<triangles>"
    + "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in FACES)
    + "</triangles></mesh>"
)
OBJECT = f'<object id="1">{MESH}</object>'
VERTICES = np.add(POINTS, [0.5, 0, 0])


def model(resources: str, build: str = '<item objectid="1"/>', more: str = "") -> str:
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<model xmlns="{CORE}" xmlns:p="{PRODUCTION}" '
        f"{more}><resources>{resources}</resources><build>{build}</build></model>"
    )


def one_object(transform: str = "") -> str:
    return model(OBJECT, f'<item objectid="1" transform="{transform}"/>')


def archive(path: Path, text: str | bytes, **others: str) -> Path:
    """Write an archive; `others` are more entries, their names with / for __."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("_rels/.rels", RELATIONSHIPS)
        file.writestr(ROOT, text)
        for name, content in others.items():
            file.writestr(name.replace("__", "/") + ".model", content)
    return path


def bent(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move all vertices but the first."""
    moved = vertices + 0.05 * np.sin(7 * vertices[:, [1, 2, 0]] + np.arange(len(vertices))[:, None])
    moved[0] = vertices[0]
    return moved


def content(path: Path, name: str = ROOT) -> bytes:
    with zipfile.ZipFile(path) as file:
        return file.read(name)


def without_coordinates(text: bytes) -> bytes:
    return re.sub(rb"""(\s[xyz]\s*=\s*)(["'])[^"']*["']""", rb"\1\2\2", text)


def moved_in_place(text: str, tmp_path: Path, **others: str) -> Document:
    """Bend all parts of an archive; check that reading the result gives the bent shapes."""
    path, target = archive(tmp_path / "in.3mf", text, **others), tmp_path / "out.3mf"
    document = read(path)
    moved = [bent(part.vertices) for part in document.parts]
    document.save(target, moved)
    for part, again, expected in zip(document.parts, read(target).parts, moved, strict=True):
        np.testing.assert_allclose(again.vertices, expected, atol=1e-7)
        np.testing.assert_array_equal(again.faces, part.faces)
    with zipfile.ZipFile(path) as before:
        for name in before.namelist():
            old, new = without_coordinates(before.read(name)), content(target, name)
            assert without_coordinates(new) == old
    return document


def test_only_the_digits_of_moved_vertices_change(tmp_path: Path) -> None:
    path, target = archive(tmp_path / "in.3mf", one_object()), tmp_path / "out.3mf"
    document = read(path)
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, VERTICES)
    np.testing.assert_array_equal(part.faces, FACES)
    assert document.save(target, [part.vertices]) == []
    assert target.read_bytes() == path.read_bytes()
    moved = part.vertices.copy()
    moved[2, 1] = 1.25
    document.save(target, [moved])
    assert content(target).decode() == one_object().replace('y="1.00"', 'y="1.25"')


def test_all_other_entries_stay_with_their_metadata(tmp_path: Path) -> None:
    path = tmp_path / "in.3mf"
    with zipfile.ZipFile(path, "w") as file:
        file.comment = b"made by hand"
        texts = {"_rels/.rels": RELATIONSHIPS, "3D/": "", ROOT: one_object(), "Schicht\u00f6": "x"}
        for name, text in texts.items():
            info = zipfile.ZipInfo(name, (2001, 2, 3, 4, 5, 6))
            info.compress_type = zipfile.ZIP_DEFLATED if "rels" in name else zipfile.ZIP_STORED
            info.comment, info.external_attr = b"note", 0o600 << 16
            info.extra = struct.pack("<HH2s", 0x7777, 2, b"ab")
            file.writestr(info, text)
    document = read(path)
    assert document.contents == ["units (millimeter)", "thumbnails and settings"]
    document.save(tmp_path / "out.3mf", [bent(document.parts[0].vertices)])
    with zipfile.ZipFile(path) as before, zipfile.ZipFile(tmp_path / "out.3mf") as after:
        assert before.comment == after.comment
        for old, new in zip(before.infolist(), after.infolist(), strict=True):
            marks = ("filename", "date_time", "compress_type", "comment", "extra", "external_attr")
            assert all(getattr(old, mark) == getattr(new, mark) for mark in marks)
            assert (before.read(old) == after.read(new)) == (old.filename != ROOT)


def test_an_item_places_an_object_by_rows(tmp_path: Path) -> None:
    document = moved_in_place(one_object("0 2 0 -3 0 0 0 0 4 5 6 7"), tmp_path)
    x, y, z = VERTICES.T
    expected = np.column_stack([5 - 3 * y, 6 + 2 * x, 7 + 4 * z])
    np.testing.assert_allclose(document.parts[0].vertices, expected)


def test_components_in_other_models_are_placed_and_named(tmp_path: Path) -> None:
    shift = "1 0 0 0 1 0 0 0 1 10 0 0"
    far = f'<component objectid="7" p:path="/3D/far.model" transform="{shift}"/>'
    text = model(
        f'<object id="1" name="own">{MESH}</object><object id="2"><components>{far}'
        f'<component objectid="1" transform="{shift}"/></components></object>'
        f'<object id="4" type="support">{MESH}</object>',
        '<item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 0"/>',
    )
    other = model(f'<object id="7">{MESH}</object>', "")
    document = moved_in_place(text, tmp_path, **{"3D__far": other})
    parts = {part.name: part.vertices for part in document.parts}
    assert list(parts) == ["own", "object 7"]
    for name in ("own", "object 7"):
        np.testing.assert_array_equal(parts[name], 2 * np.add(VERTICES, [10, 0, 0]))


def test_a_vertex_is_patched_however_it_is_written(tmp_path: Path) -> None:
    vertices = (
        "<vertex z = '0'\n\ty='0' pid='x=\"7\"' x='0.5'></vertex>"
        "<vertex   x=\"&#49;.5\" y='0e0'  z=\"-0\" extra='>'/>\r\n<vertex y='1' x='.5' z='0'   />"
        "<vertex z='1' x='5E-1' y='0'/>"
    )
    text = model(re.sub(r"(?s)<vert.*vertices>", f"<vertices>{vertices}</vertices>", OBJECT))
    document = read(archive(tmp_path / "in.3mf", text))
    document.save(tmp_path / "out.3mf", [np.add(document.parts[0].vertices, [0.25, 0, 0])])
    for old, new in (
        ("'0.5'", "'0.75'"),
        ("&#49;.5", "1.75"),
        ("'.5'", "'0.75'"),
        ("5E-1", "0.75"),
    ):
        text = text.replace(old, new)
    assert content(tmp_path / "out.3mf").decode() == text


def test_units_materials_and_slices_are_reported(tmp_path: Path) -> None:
    text = model(f'<basematerials id="5"/><s:slicestack id="6"/>{OBJECT}', more='unit="inch"')
    document = moved_in_place(text.replace("<model", '<model xmlns:s="urn:s"'), tmp_path)
    assert document.contents == ["units (inch)", "materials", "slices"]
    assert document.save(tmp_path / "out.3mf", [VERTICES + 1]) == ["its slices stay as they are"]


def test_objects_used_exponentially_often_are_read_once(tmp_path: Path) -> None:
    levels = "".join(
        f'<object id="{level + 1}"><components>'
        + f'<component objectid="{level}"/>' * 4
        + f'<component objectid="{level}" transform="{2 + level / 7} 0 0 0 2 0 0 0 1 0 0 0"/>'
        + "</components></object>"
        for level in range(1, 60)
    )
    document = read(archive(tmp_path / "in.3mf", model(OBJECT + levels, '<item objectid="60"/>')))
    assert [part.name for part in document.parts] == ["object 1"]
    assert len(document.parts[0].copies) < 1000
    assert len(document.warnings) == 2
    assert "placed 1000 times or more" in document.warnings[1]


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ('x="1.50"', 'x="nan"', "vertex 1"),
        ('x="1.50"', "", "not found: 'x'"),
        ('v1="2"', 'v1="4"', "of 4 vertices"),
        ('objectid="1"', 'objectid="9"', "no object 9"),
        ("<mesh>", '<components><component objectid="1"/></components><mesh>', "cycle"),
        ("<resources>", "<resources><vertex x='0' y='0' z='0'/>", "outside meshes"),
        ("<resources>", '<resources><object id="1"/>', "two objects"),
        ("</model>", "", "no element found"),
        ("<triangle ", "<square ", "no triangles"),
        ("?>\n", '?>\n<!DOCTYPE model [<!ENTITY a "b">]>', "document type"),
    ],
)
def test_a_malformed_model_is_refused(old: str, new: str, match: str, tmp_path: Path) -> None:
    path = archive(tmp_path / "in.3mf", one_object().replace(old, new))
    with pytest.raises(MeshFileError, match=match):
        read(path)


def test_a_damaged_archive_is_refused(tmp_path: Path) -> None:
    path = archive(tmp_path / "in.3mf", one_object())
    data = path.read_bytes()
    for size in range(0, len(data), 7):
        path.write_bytes(data[:size])
        with pytest.raises(MeshFileError):
            read(path)
    flag = data.index(b"PK\x01\x02") + 8
    path.write_bytes(data[:flag] + b"\1" + data[flag + 1 :])
    with pytest.raises(MeshFileError, match=r"encrypted.*without"):
        read(path)


def test_a_bomb_is_not_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget.Budget.__init__, "__defaults__", (1 << 20, 0.5))
    with pytest.raises(MeshFileError, match="would grow"):
        read(archive(tmp_path / "in.3mf", one_object() + " " * (2 << 20)))
