"""3MF: the digits of vertices are replaced, and every other byte of the models stays."""

from __future__ import annotations

import contextlib
import io
import re
import struct
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from meshlab_spectral.documents import three_mf
from meshlab_spectral.documents.three_mf import ThreeMfDocument, read
from meshlab_spectral.errors import MeshFileError
from numpy.typing import NDArray

FIELD = Path(__file__).resolve().parents[4] / "shared" / "field"
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
VERTICES = np.add(POINTS, [0.5, 0, 0])


def model(resources: str, build: str = '<item objectid="1"/>', more: str = "") -> str:
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<model xmlns="{CORE}" xmlns:p="{PRODUCTION}" '
        f"{more}><resources>{resources}</resources><build>{build}</build></model>"
    )


def one_object(transform: str = "") -> str:
    item = f'<item objectid="1" transform="{transform}"/>' if transform else '<item objectid="1"/>'
    return model(f'<object id="1">{MESH}</object>', item)


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


def save_bent(document: ThreeMfDocument, target: Path) -> list[NDArray[np.float64]]:
    moved = [bent(part.vertices) for part in document.parts]
    document.save(target, moved)
    return moved


def content(path: Path, name: str = ROOT) -> bytes:
    with zipfile.ZipFile(path) as file:
        return file.read(name)


def without_coordinates(text: bytes) -> bytes:
    return re.sub(rb"""(\s[xyz]\s*=\s*)(["'])[^"']*["']""", rb"\1\2\2", text)


def moved_in_place(text: str, tmp_path: Path, **others: str) -> ThreeMfDocument:
    """Bend all parts of an archive; check that reading the result gives the bent shapes."""
    path, target = archive(tmp_path / "in.3mf", text, **others), tmp_path / "out.3mf"
    document = read(path)
    moved = save_bent(document, target)
    for part, again, expected in zip(document.parts, read(target).parts, moved, strict=True):
        np.testing.assert_allclose(again.vertices, expected, atol=1e-7)
        np.testing.assert_array_equal(again.faces, part.faces)
    with zipfile.ZipFile(path) as before:
        for name in before.namelist():
            old, new = without_coordinates(before.read(name)), content(target, name)
            assert without_coordinates(new) == old
    return document


def coordinates(text: bytes) -> NDArray[np.float64]:
    """The vertices of a model, read without the package."""
    vertices = ElementTree.fromstring(text).iter(f"{{{CORE}}}vertex")
    return np.array([[float(vertex.attrib[axis]) for axis in "xyz"] for vertex in vertices])


def test_a_mesh_that_has_not_moved_gives_an_identical_file(tmp_path: Path) -> None:
    path = archive(tmp_path / "in.3mf", one_object())
    document = read(path)
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, VERTICES)
    np.testing.assert_array_equal(part.faces, FACES)
    assert document.save(tmp_path / "out.3mf", [part.vertices]) == []
    assert (tmp_path / "out.3mf").read_bytes() == path.read_bytes()


def test_only_the_digits_of_what_has_moved_change(tmp_path: Path) -> None:
    document = read(archive(tmp_path / "in.3mf", one_object()))
    moved = document.parts[0].vertices.copy()
    moved[2, 1] = 1.25
    document.save(tmp_path / "out.3mf", [moved])
    expected = one_object().replace('y="1.00"', 'y="1.25"')
    assert content(tmp_path / "out.3mf").decode() == expected


def test_any_writing_of_a_vertex_is_patched(tmp_path: Path) -> None:
    vertices = (
        "<vertex z = '0'\n\ty='0' pid='x=\"7\"' x='0.5'></vertex><!-- <vertex x='3'/> -->"
        "<vertex   x=\"&#49;.5\" y='0e0'  z=\"-0\" extra='>'/>\r\n<vertex y='1' x='.5' z='0'   />"
        "<vertex z='1' x='5E-1' y='0'/>"
    )
    written = re.sub(r"<vertices>.*</vertices>", f"<vertices>{vertices}</vertices>", MESH, flags=16)
    text = model(f'<object id="1">{written}</object>')
    path = archive(tmp_path / "in.3mf", text)
    document = read(path)
    np.testing.assert_array_equal(document.parts[0].vertices, VERTICES)
    moved = np.add(document.parts[0].vertices, [0.25, 0, 0])
    document.save(tmp_path / "out.3mf", [moved])
    expected = text
    for old, new in (
        ("'0.5'", "'0.75'"),
        ("&#49;.5", "1.75"),
        ("'.5'", "'0.75'"),
        ("5E-1", "0.75"),
    ):
        expected = expected.replace(old, new)
    assert content(tmp_path / "out.3mf").decode() == expected


def test_a_prefixed_namespace_and_a_byte_order_mark_are_read(tmp_path: Path) -> None:
    text = one_object().replace("xmlns=", "xmlns:c=")
    text = re.sub(r"<(/?)(?=[a-z])", r"<\1c:", text)
    document = read(archive(tmp_path / "in.3mf", b"\xef\xbb\xbf" + text.encode()))
    moved = save_bent(document, tmp_path / "out.3mf")
    np.testing.assert_allclose(read(tmp_path / "out.3mf").parts[0].vertices, moved[0], atol=1e-8)


def test_large_coordinates_get_the_digits_that_they_need(tmp_path: Path) -> None:
    text = one_object().replace('x="', 'x="40000').replace('z="1"', 'z="4e7"')
    document = read(archive(tmp_path / "in.3mf", text))
    moved = save_bent(document, tmp_path / "out.3mf")
    np.testing.assert_array_equal(read(tmp_path / "out.3mf").parts[0].vertices, moved[0])


def test_all_other_entries_stay_with_their_marks(tmp_path: Path) -> None:
    path = tmp_path / "in.3mf"
    with zipfile.ZipFile(path, "w") as file:
        file.comment = b"made by hand"
        for name, method in (
            ("Metadata/thumbnail.png", zipfile.ZIP_STORED),
            ("_rels/.rels", zipfile.ZIP_DEFLATED),
            ("3D/", zipfile.ZIP_STORED),
            (ROOT, zipfile.ZIP_DEFLATED),
            ("Metadata/Schicht\u00f6.config", zipfile.ZIP_BZIP2),
        ):
            info = zipfile.ZipInfo(name, (2001, 2, 3, 4, 5, 6))
            info.compress_type, info.comment, info.external_attr = method, b"note", 0o600 << 16
            info.extra = struct.pack("<HH2s", 0x7777, 2, b"ab")
            text = {"_rels/.rels": RELATIONSHIPS, ROOT: one_object(), "3D/": ""}.get(name, name)
            file.writestr(info, text)
    document = read(path)
    assert document.contents == ["units (millimeter)", "thumbnails and settings"]
    save_bent(document, tmp_path / "out.3mf")
    with zipfile.ZipFile(path) as before, zipfile.ZipFile(tmp_path / "out.3mf") as after:
        assert before.comment == after.comment
        for old, new in zip(before.infolist(), after.infolist(), strict=True):
            for key in ("filename", "date_time", "compress_type", "comment", "extra"):
                assert getattr(old, key) == getattr(new, key)
            assert old.external_attr == new.external_attr
            assert (before.read(old) == after.read(new)) == (old.filename != ROOT)


def test_an_item_places_an_object_by_rows(tmp_path: Path) -> None:
    document = moved_in_place(one_object("0 2 0 -3 0 0 0 0 4 5 6 7"), tmp_path)
    x, y, z = VERTICES.T
    expected = np.column_stack([5 - 3 * y, 6 + 2 * x, 7 + 4 * z])
    np.testing.assert_allclose(document.parts[0].vertices, expected)
    assert document.contents == ["units (millimeter)", "placement"]


def test_a_mirrored_object_stays_outside_out(tmp_path: Path) -> None:
    (part,) = moved_in_place(one_object("-1 0 0 0 1 0 0 0 1 0 0 0"), tmp_path).parts
    assert np.linalg.det(part.vertices[part.faces]).sum() == pytest.approx(1)


def test_a_flattened_object_is_taken_without_its_transform(tmp_path: Path) -> None:
    document = moved_in_place(one_object("1 0 0 0 1 0 0 0 0 0 0 0"), tmp_path)
    np.testing.assert_array_equal(document.parts[0].vertices, VERTICES)
    assert "object 1 is flattened" in document.warnings[0]


def test_components_in_other_models_are_placed_and_named(tmp_path: Path) -> None:
    shift = "1 0 0 0 1 0 0 0 1 10 0 0"
    far = f'<component objectid="7" p:path="/3D/far.model" transform="{shift}"/>'
    text = model(
        f'<object id="1" name="own">{MESH}</object><object id="2"><components>{far}'
        f'<component objectid="1" transform="{shift}"/></components></object>'
        f'<object id="3" partnumber="P-3">{MESH}</object>'
        f'<object id="4" type="support">{MESH}</object>',
        '<item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 0"/>',
    )
    other = model(f'<object id="7">{MESH}</object>', "")
    document = moved_in_place(text, tmp_path, **{"3D__far": other})
    parts = {part.name: part.vertices for part in document.parts}
    assert list(parts) == ["own", "P-3", "object 7"]
    for name in ("own", "object 7"):
        np.testing.assert_array_equal(parts[name], 2 * np.add(VERTICES, [10, 0, 0]))
    np.testing.assert_array_equal(parts["P-3"], VERTICES)
    assert document.contents == ["units (millimeter)", "placement", "names"]


@pytest.mark.parametrize(("scale", "warns"), [(2, True), (-1, False)])
def test_the_first_placement_counts_and_another_scale_is_told(
    scale: int, warns: bool, tmp_path: Path
) -> None:
    items = '<item objectid="1"/>' * 5 + (
        f'<item objectid="1" transform="{scale} 0 0 0 {scale} 0 0 0 {scale} 0 0 0"/>'
    )
    document = moved_in_place(model(f'<object id="1">{MESH}</object>', items), tmp_path)
    np.testing.assert_array_equal(document.parts[0].vertices, VERTICES)
    assert len(document.warnings) == warns


def test_units_materials_slices_and_beams_are_told_and_stay(tmp_path: Path) -> None:
    resources = (
        '<basematerials id="5"/><s:slicestack id="6"/><m:texture2d path="/3D/skin.model"/>'
        f'<object id="1">{MESH}<b:beamlattice/></object>'
    )
    spaces = 'unit="inch" xmlns:s="urn:s" xmlns:m="urn:m" xmlns:b="urn:b"'
    text = model(resources, more=spaces)
    document = moved_in_place(text, tmp_path, **{"3D__skin": "pixels"})
    assert document.contents == [
        "units (inch)",
        "materials and colours",
        "textures",
        "slices",
        "beams",
    ]
    moved = [bent(document.parts[0].vertices)]
    assert document.save(tmp_path / "out.3mf", moved) == ["its slices stay as they are"]


def test_objects_used_exponentially_often_are_read_once(tmp_path: Path) -> None:
    levels = "".join(
        f'<object id="{level + 1}"><components>'
        + f'<component objectid="{level}"/>' * 4
        + f'<component objectid="{level}" transform="{2 + level / 7} 0 0 0 2 0 0 0 1 0 0 0"/>'
        + "</components></object>"
        for level in range(1, 60)
    )
    text = model(f'<object id="1">{MESH}</object>{levels}', '<item objectid="60"/>')
    document = read(archive(tmp_path / "in.3mf", text))
    assert [part.name for part in document.parts] == ["object 1"]
    assert len(document.warnings) == 1


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ('x="1.50"', 'x="nan"', "vertex 1"),
        ('x="1.50"', 'x="1e999"', "vertex 1"),
        ('x="1.50"', 'x="one"', "line 4.*one"),
        ('x="1.50"', "", "'x' is missing"),
        ('v1="2"', 'v1="-1"', "face"),
        ('v1="2"', 'v1="4"', "of 4 vertices"),
        ('v1="2"', f'v1="{10**30}"', "large|big"),
        ('v1="2"', 'v1="2.5"', "2.5"),
        ('id="1"><mesh>', "><mesh>", "'id' is missing"),
        ('objectid="1"', 'objectid="9"', "no object 9"),
        ('objectid="1"', 'objectid="1" transform="1 2"', "2 numbers"),
        ('objectid="1"', 'objectid="1" transform="a 0 0 0 1 0 0 0 1 0 0 0"', "line"),
        ('objectid="1"', 'objectid="1" transform="inf 0 0 0 1 0 0 0 1 inf 0 0"', None),
        ('objectid="1"', 'objectid="1" p:path="/3D/lost.model"', "lost.model"),
        ("<resources>", "<resources><vertex x='0' y='0' z='0'/>", "outside an object"),
        ("<resources>", '<resources><object id="1"/>', "second object 1"),
        ("</model>", "", "no element found"),
        ("<model", "<html", "mismatched|instead"),
        ("<triangle ", "<square ", "no triangles"),
        ("<?xml", "\0<?xml", "UTF-16"),
        ("?>\n", '?>\n<!DOCTYPE model [<!ENTITY a "b">]>', "document type"),
    ],
)
def test_a_malformed_model_is_told(old: str, new: str, match: str | None, tmp_path: Path) -> None:
    path = archive(tmp_path / "in.3mf", one_object().replace(old, new))
    if match is None:
        assert read(path).warnings
        return
    with pytest.raises(MeshFileError, match=match):
        read(path)


@pytest.mark.parametrize("length", [1, 2, 5])
def test_components_in_a_circle_are_told(length: int, tmp_path: Path) -> None:
    objects = "".join(
        f'<object id="{i + 2}"><components><component objectid="{(i + 1) % length + 2}"/>'
        "</components></object>"
        for i in range(length)
    )
    with pytest.raises(MeshFileError, match="circle"):
        read(archive(tmp_path / "in.3mf", model(f'<object id="1">{MESH}</object>{objects}')))


def test_a_deep_chain_of_components_is_read(tmp_path: Path) -> None:
    count = 5000
    objects = "".join(
        f'<object id="{i + 1}"><components><component objectid="{i}" '
        'transform="1 0 0 0 1 0 0 0 1 0 0 1"/></components></object>'
        for i in range(1, count)
    )
    text = model(f'<object id="1">{MESH}</object>{objects}', f'<item objectid="{count}"/>')
    (part,) = read(archive(tmp_path / "in.3mf", text)).parts
    np.testing.assert_array_equal(part.vertices, np.add(VERTICES, [0, 0, count - 1]))


def test_an_archive_cut_anywhere_is_told(tmp_path: Path) -> None:
    data = archive(tmp_path / "in.3mf", one_object()).read_bytes()
    path = tmp_path / "cut.3mf"
    for size in range(0, len(data), 7):
        path.write_bytes(data[:size])
        with pytest.raises(MeshFileError):
            read(path)


def test_an_archive_with_any_byte_changed_is_told_or_harmless(tmp_path: Path) -> None:
    data = archive(tmp_path / "in.3mf", one_object()).read_bytes()
    path = tmp_path / "changed.3mf"
    for position in range(len(data)):
        changed = bytearray(data)
        changed[position] ^= 1 << position % 8
        path.write_bytes(changed)
        with contextlib.suppress(MeshFileError):
            save_bent(read(path), tmp_path / "out.3mf")


def test_a_bomb_is_not_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(three_mf, "_HARMLESS", 1 << 20)
    text = one_object() + " " * (2 << 20)
    with pytest.raises(MeshFileError, match="would grow"):
        read(archive(tmp_path / "in.3mf", text))


@pytest.mark.parametrize(
    ("name", "match"), [("../evil", "named"), ("a\\..\\evil", "named"), (ROOT, "one name")]
)
@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_misleading_names_are_refused(name: str, match: str, tmp_path: Path) -> None:
    path = archive(tmp_path / "in.3mf", one_object())
    with zipfile.ZipFile(path, "a") as file:
        file.writestr(name, "x")
    with pytest.raises(MeshFileError, match=match):
        read(path)


def test_encrypted_archives_are_refused(tmp_path: Path) -> None:
    path = archive(tmp_path / "in.3mf", one_object())
    data = bytearray(path.read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(data)
    with pytest.raises(MeshFileError, match=r"encrypted.*without"):
        read(path)
    secure = RELATIONSHIPS.replace("metadata/thumbnail", "2019/04/keystore")
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("_rels/.rels", secure)
        file.writestr(ROOT, one_object())
    with pytest.raises(MeshFileError, match="encrypted"):
        read(path)


@pytest.mark.parametrize("relationships", [None, "<Relationships xmlns='r'/>", "text"])
def test_an_archive_without_a_model_is_told(relationships: str | None, tmp_path: Path) -> None:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as file:
        if relationships:
            file.writestr("_rels/.rels", relationships)
    (tmp_path / "in.3mf").write_bytes(buffer.getvalue())
    with pytest.raises(MeshFileError, match="rels"):
        read(tmp_path / "in.3mf")


@pytest.mark.skipif(not FIELD.is_dir(), reason="the files that users brought are not here")
@pytest.mark.parametrize("name", ["inch", "item_transform"])
def test_files_that_users_brought_keep_all_but_digits(name: str, tmp_path: Path) -> None:
    path, target = FIELD / f"{name}.3mf", tmp_path / "out.3mf"
    document = read(path)
    document.save(target, [part.vertices for part in document.parts])
    assert target.read_bytes() == path.read_bytes()
    (moved,) = save_bent(document, target)
    np.testing.assert_allclose(read(target).parts[0].vertices, moved, atol=1e-7)
    assert without_coordinates(content(target)) == without_coordinates(content(path))
    old, new = (coordinates(content(path)), coordinates(content(target)))
    assert old.shape == new.shape
    np.testing.assert_array_equal(new[0], old[0])
    assert (new[1:] != old[1:]).any(axis=1).all()
