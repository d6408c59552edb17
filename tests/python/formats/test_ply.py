"""In a PLY file only the coordinates and normals of moved vertices change."""

from __future__ import annotations

import os
import re
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.document import Array
from meshlab_spectral.formats.names import shown
from meshlab_spectral.formats.normals import following_normals
from meshlab_spectral.formats.ply import PlyDocument, read
from meshlab_spectral.formats.side_files import copy_side_files
from plyfile import PlyData

FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")
CODES = {"uchar": "B", "int": "i", "uint": "I", "short": "h", "float": "f", "double": "d"}

Element = tuple[str, list[str], list[list[object]]]  # name, properties, rows

CORNERS = [[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
QUADS = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
HALVES = [half for a, b, c, d in QUADS for half in ([a, b, c], [a, c, d])]


def encoded(format_: str, elements: list[Element], notes: list[str] | None = None) -> bytes:
    """Write a PLY file independently of the code under test."""
    header = ["ply", f"format {format_} 1.0", *(notes or [])]
    for name, properties, rows in elements:
        header += [f"element {name} {len(rows)}", *(f"property {one}" for one in properties)]
    data = [_row(format_, properties, row) for _, properties, rows in elements for row in rows]
    return "\n".join([*header, "end_header", ""]).encode() + b"".join(data)


def _row(format_: str, properties: list[str], row: list[object]) -> bytes:
    numbers: list[tuple[str, object]] = []
    for one, value in zip(properties, row, strict=True):
        *types, _ = one.replace("list ", "").split()
        values = [len(value), *value] if isinstance(value, list) else [value]
        numbers += [(types[min(k, len(types) - 1)], item) for k, item in enumerate(values)]
    if format_ == "ascii":
        return " ".join(str(number) for _, number in numbers).encode() + b"\n"
    order = ">" if "big" in format_ else "<"
    return b"".join(struct.pack(order + CODES[type_], number) for type_, number in numbers)


def vertices(type_: str = "float", points: list[list[float]] = CORNERS) -> Element:
    return "vertex", [f"{type_} {axis}" for axis in "xyz"], [list(point) for point in points]


def faces(polygons: list[list[int]], list_: str = "list uchar int vertex_indices") -> Element:
    return "face", [list_], [[corners] for corners in polygons]


def decorated() -> list[Element]:
    """A cube with one of everything; its normals are those of its corners."""
    outwards = ((np.array(CORNERS) - 0.5) / np.sqrt(0.75)).tolist()
    names = ["uchar red", *(f"float {name}" for name in ("nx", "ny", "nz", "x", "y", "z"))]
    names += ["float confidence", "list uchar int wind"]
    rows = [[i, *outwards[i], *p, 0.25 * i, [i, 1, 2]] for i, p in enumerate(CORNERS)]
    return [
        ("camera", ["float focal", "int flags"], [[1.5, 7]]),
        ("history", ["list uchar short events"], [[[1, 2]], [[3]]]),
        ("vertex", names, rows),
        ("face", ["short part", "list uchar uint vertex_index"], [[-1, q] for q in QUADS]),
        ("edge", ["int vertex1", "int vertex2"], [[0, 1]]),
    ]


def write(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


def saved(document: PlyDocument, target: Path, after: Array) -> tuple[bytes, list[str]]:
    warnings = document.save(target, [after])
    return target.read_bytes(), warnings


@pytest.mark.parametrize("format_", FORMATS)
def test_everything_in_a_file_is_read(format_: str, tmp_path: Path) -> None:
    notes = ["comment by hand", "obj_info a cube", "comment TextureFile my skin.png"]
    document = read(write(tmp_path / "a.ply", encoded(format_, decorated(), notes)))
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, CORNERS)
    assert part.faces.tolist() == HALVES
    np.testing.assert_array_equal(part.quality, 0.25 * np.arange(8))
    assert document.contents == [
        *("normals", "colours", "polygons", "comments", "texture names"),
        *(f"property {name}" for name in ("confidence", "part", "wind")),
        *("element camera", "element history", "element edge"),
    ]


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize("list_", ["list uchar int vertex_indices", "list int short vertex_index"])
@pytest.mark.parametrize("polygons", [HALVES, QUADS, [*HALVES[:6], *QUADS[3:]]])
def test_faces_of_any_type_become_triangles(
    polygons: list[list[int]], list_: str, format_: str, tmp_path: Path
) -> None:
    content = encoded(format_, [faces(polygons, list_), vertices("double")])  # faces come first
    document = read(write(tmp_path / "a.ply", content))
    assert document.parts[0].faces.tolist() == HALVES
    assert ("polygons" in document.contents) == (polygons is not HALVES)


@pytest.mark.parametrize("format_", FORMATS)
def test_strips_become_triangles_that_face_the_same_side(format_: str, tmp_path: Path) -> None:
    strips = ("tristrips", ["list int int vertex_indices"], [[[0, 1, 2, 3, -1, 4, 6, 5]], [[1, 0]]])
    document = read(write(tmp_path / "a.ply", encoded(format_, [vertices(), strips])))
    assert document.parts[0].faces.tolist() == [[0, 1, 2], [1, 3, 2], [4, 6, 5]]


@pytest.mark.parametrize("format_", FORMATS)
def test_a_file_without_faces_is_a_part_without_faces(format_: str, tmp_path: Path) -> None:
    for elements in ([vertices()], [vertices(), faces([])], [vertices(points=[]), faces([])]):
        document = read(write(tmp_path / "a.ply", encoded(format_, elements)))
        assert document.parts[0].faces.shape == (0, 3)
        assert document.parts[0].quality is None


def test_quality_is_preferred_to_confidence_unless_it_is_an_integer(tmp_path: Path) -> None:
    for type_, expected in (("double", 2), ("int", 1)):
        names = ["float x", "float y", "float z", "float confidence", f"{type_} quality"]
        content = encoded("ascii", [("vertex", names, [[0, 0, 0, 1, 2]])])
        assert read(write(tmp_path / "a.ply", content)).parts[0].quality == expected


@pytest.mark.parametrize("newline", [b"\n", b"\r\n"])
@pytest.mark.parametrize("format_", FORMATS)
def test_where_nothing_moves_the_file_is_identical(
    format_: str, newline: bytes, tmp_path: Path
) -> None:
    content = encoded(format_, decorated(), ["comment  \u00e9t\u00e9 ", "obj_info x"])
    head, end, data = content.partition(b"end_header\n")
    header = (head + end).replace(b"element face", b"obj_info caf\xe9\nelement face")
    data = data.replace(b"\n", newline) if format_ == "ascii" else data
    path = write(tmp_path / "a.ply", header.replace(b"\n", newline) + data + b"\nrest")
    document = read(path)
    same = saved(document, tmp_path / "b.ply", document.parts[0].vertices)
    assert same == (path.read_bytes(), [])


@pytest.mark.parametrize("format_", FORMATS)
def test_only_coordinates_and_normals_change(format_: str, tmp_path: Path) -> None:
    path = write(tmp_path / "a.ply", encoded(format_, decorated(), ["comment by hand"]))
    document = read(path)
    after = document.parts[0].vertices * [1.0, 1.0, 1.5]
    content, warnings = saved(document, tmp_path / "b.ply", after)
    assert warnings == []
    assert content.partition(b"end_header")[0] == path.read_bytes().partition(b"end_header")[0]
    old, new = PlyData.read(str(path)), PlyData.read(str(tmp_path / "b.ply"))
    np.testing.assert_array_equal(np.column_stack([new["vertex"][axis] for axis in "xyz"]), after)
    normals = np.column_stack([new["vertex"][f"n{axis}"] for axis in "xyz"])
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
    for element in old:
        for one in element.properties:
            if element.name != "vertex" or one.name[-1] not in "xyz":
                pairs = zip(element[one.name], new[element.name][one.name], strict=True)
                assert all(np.array_equal(a, b) for a, b in pairs)


def test_in_a_text_file_only_the_numbers_that_changed_are_rewritten(tmp_path: Path) -> None:
    content = (
        b"ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty int id\r\nproperty float x\r\n"
        b"property float y\r\nproperty float z\r\nelement face 1\r\n"
        b"property list uchar int vertex_indices\r\nend_header\r\n"
        b"7  0.000 1e0\t 2.50 \r\n\r\n  8 1 0 0\r\n9 0 +1 0\r\n3 0 1 2\r\n# the end"
    )
    document = read(write(tmp_path / "a.ply", content))
    after = document.parts[0].vertices.copy()
    after[0, 1], after[2, 0] = 1.25, -1 / 3
    expected = content.replace(b"1e0\t", b"1.25\t").replace(b"9 0 +1", b"9 -0.333333333 +1")
    assert saved(document, tmp_path / "b.ply", after) == (expected, [])


@pytest.mark.parametrize("format_", FORMATS)
def test_coordinates_become_double_where_single_precision_loses_the_movement(
    format_: str, tmp_path: Path
) -> None:
    points = (np.array(CORNERS) + 500000).tolist()
    camera: Element = ("camera", ["float x"], [[1.5]])
    content = encoded(format_, [camera, vertices(points=points), faces(HALVES)])
    document = read(write(tmp_path / "scan.ply", content))
    after = document.parts[0].vertices + np.linspace(0.001, 0.002, 24).reshape(8, 3)
    content, warnings = saved(document, tmp_path / "b.ply", after)
    assert "written in double precision, since single precision rounds" in warnings[0]
    assert content.count(b"property double") == 3
    np.testing.assert_array_equal(read(tmp_path / "b.ply").parts[0].vertices, after)


@pytest.mark.parametrize("names", ["float y|float x|float z", "float x|float y|list uchar float z"])
def test_unusual_coordinates_are_refused_with_a_remedy(names: str, tmp_path: Path) -> None:
    row: list[object] = [[0] if "list" in name else 0 for name in names.split("|")]
    path = write(tmp_path / "a.ply", encoded("ascii", [("vertex", names.split("|"), [row])]))
    with pytest.raises(MeshFileError, match="export it again"):
        read(path)


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize("type_", ["uchar", "short", "int", "mixed"])
def test_integer_coordinates_become_floats_where_they_move(
    type_: str, format_: str, tmp_path: Path
) -> None:
    types = ["int", "float", "uchar"] if type_ == "mixed" else 3 * [type_]
    points = [[int(10 * x) for x in corner] for corner in CORNERS]
    names = [f"{one} {axis}" for one, axis in zip(types, "xyz", strict=True)]
    content = encoded(format_, [("vertex", names, points), faces(HALVES)])
    document = read(write(tmp_path / "in.ply", content))
    np.testing.assert_array_equal(document.parts[0].vertices, points)
    assert saved(document, tmp_path / "same.ply", document.parts[0].vertices) == (content, [])
    after = document.parts[0].vertices + np.linspace(0.1, 0.2, 24).reshape(8, 3)
    content, warnings = saved(document, tmp_path / "b.ply", after)
    assert "written in double precision, since the file has integers" in warnings[0]
    np.testing.assert_allclose(read(tmp_path / "b.ply").parts[0].vertices, after, rtol=1e-8)


CUBE = encoded("ascii", [vertices(), faces(HALVES)])


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_rows_of_a_text_may_run_over_any_lines(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    polygons = data.draw(st.sampled_from([HALVES, QUADS, [*HALVES[:6], *QUADS[3:]]]))
    one_per_line = encoded("ascii", [vertices(), faces(polygons)])
    head, body = one_per_line.split(b"end_header\n")
    gaps = st.sampled_from([b" ", b"  ", b"\n", b"\r\n", b"\t\n\n"])
    text = head + b"end_header\n" + b"".join(word + data.draw(gaps) for word in body.split())
    folder = tmp_path_factory.mktemp("ply")
    expected, document = (
        read(write(folder / name, one))
        for name, one in (("lines.ply", one_per_line), ("words.ply", text))
    )
    np.testing.assert_array_equal(document.parts[0].vertices, expected.parts[0].vertices)
    np.testing.assert_array_equal(document.parts[0].faces, expected.parts[0].faces)
    assert saved(document, folder / "same.ply", document.parts[0].vertices) == (text, [])
    after = document.parts[0].vertices.copy()
    after[5] += [0, 0, 0.25]
    content, _ = saved(document, folder / "moved.ply", after)
    np.testing.assert_array_equal(read(folder / "moved.ply").parts[0].vertices, after)
    before, new = (re.split(rb"(\s+)", one) for one in (text, content))
    assert sum(a != b for a, b in zip(before, new, strict=True)) == 1
    with pytest.raises(MeshFileError, match="element"):
        read(write(folder / "cut.ply", text.rstrip().rpartition(b"0")[0]))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (b"ply\n", b"Dear all,\n", "is not PLY"),
        (b"element vertex", b"element points", "no PLY header with vertices"),
        (b"float y", b"floot y", "line 5"),
        (b"float y", b"float w", "without x, y, z"),
        (b"vertex 8", b"vertex -8", "-8"),
        (b"1.0 0.0 0.0\n", b"1.0 0.0\n", "element 'vertex': row 1"),
        (b"1.0 0.0 0.0\n", b"1.0 0.0 0.0 0.0\n", "element 'vertex': row 1"),
        (b"1.0 0.0 0.0\n", b"1.0 0.0 nan\n", "vertex 1"),
        (b"\n3 0 3 1\n", b"\n3 0 3 8\n", "face 1"),
        (b"\n3 0 3 1\n", b"\n2000000000 0 3 1\n", "2000000000"),
        (b"\n3 0 3 1\n", b"\nthree 0 3 1\n", "element 'face': row 1"),
    ],
)
def test_a_damaged_text_file_is_refused_with_the_place(
    old: bytes, new: bytes, words: str, tmp_path: Path
) -> None:
    assert CUBE.count(old) == 1
    path = write(tmp_path / "a.ply", CUBE.replace(old, new))
    with pytest.raises(MeshFileError, match=rf"a\.ply.*{words}"):
        read(path)


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize("polygons", [HALVES, [*HALVES[:6], *QUADS[3:]]])
def test_a_file_cut_off_or_with_a_vast_count_is_refused(
    polygons: list[list[int]], format_: str, tmp_path: Path
) -> None:
    content = encoded(format_, [vertices(), faces(polygons)])
    vast = [content.replace(one, one + b"2000000000") for one in (b"vertex ", b"face ")]
    for damaged in [*(content[:size] for size in range(0, len(content) - 2, 7)), *vast]:
        with pytest.raises(MeshFileError) as error:
            read(write(tmp_path / "a.ply", damaged))
        cause = "damaged" if damaged in vast else "cut_off" if damaged else "empty"
        assert error.value.code == cause


def test_textures_are_copied_next_to_the_file_and_never_elsewhere(tmp_path: Path) -> None:
    for name in ("in/maps", "out/scratch", "elsewhere"):
        (tmp_path / name).mkdir(parents=True)
    for name in ("in/my skin.png", "in/maps/b.png", "secret.png", "in/a.ply"):
        (tmp_path / name).write_bytes(name.encode())
    (tmp_path / "out/scratch/link").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "in/link").symlink_to(tmp_path / "in/maps")
    bad = ["../secret.png", str(tmp_path / "secret.png"), "C:\\d.png", "no.png", "a.ply"]
    names = ["my skin.png", "maps/b.png", *bad, "link/b.png", "maps", "x" * 5000]
    notes = [f"comment TextureFile {name}" for name in names]
    document = read(write(tmp_path / "in/a.ply", encoded("ascii", [vertices()], notes)))
    target = tmp_path / "out/scratch/a.ply"
    for _ in range(2):  # the second time the same files exist
        warnings = document.save(target, [document.parts[0].vertices * 2])
        assert [warning.split(" is not")[0].split(",")[0] for warning in warnings] == [
            *map(shown, names[2:])
        ]
    assert (target.parent / "maps/b.png").read_bytes() == b"in/maps/b.png"
    assert sorted(path.name for path in target.parent.rglob("*.*")) == ["a.ply", "b.png", names[0]]
    assert not list((tmp_path / "elsewhere").iterdir())
    assert document.save(tmp_path / "in/scratch.ply", [document.parts[0].vertices]) == []


def test_a_texture_of_the_same_size_and_time_is_another_file(tmp_path: Path) -> None:
    source, target = tmp_path / "in" / "mesh.ply", tmp_path / "out" / "mesh.ply"
    for path, content in ((source, b"red"), (target, b"tan")):
        path.parent.mkdir()
        skin = path.with_name("skin.png")
        skin.write_bytes(content)
        os.utime(skin, (1e9, 1e9))
    (warning,) = copy_side_files(source, target, ["skin.png"])
    assert "another file has that name" in warning


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_normal_follows_a_face_that_turns_over(side: float) -> None:
    V, up = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0.0, 0, side]] * 3)
    turned = following_normals(V, V * [1, -1, 1], np.array([[0, 1, 2]]), up)
    np.testing.assert_array_equal(turned, -up)


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize("is_last", [False, True])
def test_lists_of_several_lengths_at_the_vertices_are_kept(
    is_last: bool, format_: str, tmp_path: Path
) -> None:
    """As of neighbours, or of the views that see a vertex."""
    if format_ == "ascii" and not is_last:
        return  # words before the coordinates of a text have to be as many in each row
    V = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    views = [list(range(k)) for k in (1, 3, 1, 2)]
    names, list_ = ["float x", "double y", "float z", "uchar age"], "list uchar uint views"
    rows: list[list[object]] = [[*point, 4 + k] for k, point in enumerate(V)]
    for row, one in zip(rows, views, strict=True):
        row.insert(len(row) if is_last else 0, one)
    names.insert(len(names) if is_last else 0, list_)
    source, target = tmp_path / "in.ply", tmp_path / "out.ply"
    write(source, encoded(format_, [("vertex", names, rows), faces([[0, 1, 2], [0, 2, 3]])]))
    document = read(source)
    np.testing.assert_array_equal(document.parts[0].vertices, V)
    moved = document.parts[0].vertices + np.array([0, 0, 0.25])
    document.save(target, [moved])
    before, after = PlyData.read(source), PlyData.read(target)
    assert str(before) == str(after)
    np.testing.assert_array_equal(after["vertex"]["z"], [0.25] * 4)
    assert [one.tolist() for one in after["vertex"]["views"]] == views
    for name in ("x", "y", "age"):
        np.testing.assert_array_equal(after["vertex"][name], before["vertex"][name])
    if format_ != "ascii":
        assert target.stat().st_size == source.stat().st_size
        moved = document.parts[0].vertices + np.linspace(1e-7, 2e-7, 12).reshape(4, 3)
        (warning,) = document.save(target, [moved])
        assert "double precision" in warning
        after = PlyData.read(target)
        found = np.column_stack([after["vertex"][name] for name in "xyz"])
        np.testing.assert_array_equal(found, moved)
        assert after["vertex"]["age"].tolist() == [4, 5, 6, 7]
        assert [one.tolist() for one in after["vertex"]["views"]] == views
        np.testing.assert_array_equal(read(target).parts[0].faces, document.parts[0].faces)
