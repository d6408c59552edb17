"""In a PLY file only the coordinates and normals of moved vertices change."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from meshlab_spectral.documents.document import Array
from meshlab_spectral.documents.ply import PlyDocument, read
from meshlab_spectral.documents.side_files import copy_side_files
from meshlab_spectral.errors import MeshFileError
from plyfile import PlyData

FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")
FIELD = Path(__file__).resolve().parents[4] / "shared" / "field"
CODES = {"uchar": "B", "int": "i", "uint": "I", "short": "h", "float": "f", "double": "d"}

# (name, properties, rows); a list property is "list <length> <item> <name>", its value a list.
Element = tuple[str, list[str], list[list[object]]]

CORNERS = [[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
QUADS = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
HALVES = [half for a, b, c, d in QUADS for half in ([a, b, c], [a, c, d])]


def encoded(format_: str, elements: list[Element], notes: list[str] | None = None) -> bytes:
    """Write a PLY file without the help of what is tested."""
    header = ["ply", f"format {format_} 1.0", *(notes or [])]
    for name, properties, rows in elements:
        header += [f"element {name} {len(rows)}", *(f"property {one}" for one in properties)]
    data = b"".join(
        _row(format_, properties, row) for _, properties, rows in elements for row in rows
    )
    return "\n".join([*header, "end_header", ""]).encode() + data


def _row(format_: str, properties: list[str], row: list[object]) -> bytes:
    numbers: list[tuple[str, object]] = []
    for one, value in zip(properties, row, strict=True):
        words = one.split()
        if isinstance(value, list):
            numbers += [(words[1], len(value)), *((words[2], item) for item in value)]
        else:
            numbers.append((words[0], value))
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
    outwards = (np.array(CORNERS) - 0.5) / np.sqrt(0.75)
    names = ["uchar red", "float x", "float nx", "double y", "float ny", "float z", "float nz"]
    rows = [
        [i, x, n[0], y, n[1], z, n[2], 0.25 * i, list(range(i % 3))]
        for i, ((x, y, z), n) in enumerate(zip(CORNERS, outwards.tolist(), strict=True))
    ]
    return [
        ("camera", ["float focal", "int flags"], [[1.5, 7]]),
        ("history", ["list uchar short events"], [[[1, 2]], [[]], [[3]]]),
        ("vertex", [*names, "float confidence", "list uchar int labels"], rows),
        ("face", ["short part", "list uchar uint vertex_index"], [[-1, q] for q in QUADS]),
        ("edge", ["int vertex1", "int vertex2"], [[0, 1]]),
    ]


def write(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


def saved(document: PlyDocument, target: Path, after: Array) -> tuple[bytes, list[str]]:
    warnings = document.save(target, [after])
    return target.read_bytes(), warnings


def stretched(document: PlyDocument) -> Array:
    return document.parts[0].vertices * [1.0, 1.0, 1.5]


@pytest.mark.parametrize("format_", FORMATS)
def test_everything_in_a_file_is_read_in_any_order(format_: str, tmp_path: Path) -> None:
    notes = ["comment by hand", "obj_info a cube", "comment TextureFile my skin.png"]
    document = read(write(tmp_path / "a.ply", encoded(format_, decorated(), notes)))
    (part,) = document.parts
    np.testing.assert_array_equal(part.vertices, CORNERS)
    assert part.faces.shape == (12, 3)
    assert part.quality is not None
    np.testing.assert_array_equal(part.quality, 0.25 * np.arange(8))
    assert document.contents == [
        "normals",
        "colours",
        "polygons",
        "edges",
        "comments",
        "texture names",
        "vertex properties confidence, labels",
        "face properties part",
        "element camera",
        "element history",
    ]


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize(
    "list_",
    [
        "list uchar int vertex_indices",
        "list int uchar vertex_index",
        "list short uint vertex_index",
    ],
)
@pytest.mark.parametrize("polygons", [HALVES, QUADS, [*HALVES[:6], *QUADS[3:]]])
def test_faces_of_any_integer_type_become_triangles(
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
    assert document.parts[0].faces.tolist() == [[0, 1, 2], [2, 1, 3], [4, 6, 5]]


@pytest.mark.parametrize("format_", FORMATS)
def test_a_file_without_faces_is_a_part_without_faces(format_: str, tmp_path: Path) -> None:
    for elements in ([vertices()], [vertices(), faces([])], [vertices(points=[])]):
        document = read(write(tmp_path / "a.ply", encoded(format_, elements)))
        assert document.parts[0].faces.shape == (0, 3)
        assert document.parts[0].quality is None


def test_quality_is_preferred_to_confidence_and_integers_are_none(tmp_path: Path) -> None:
    def quality(*properties: str) -> list[float] | None:
        row: list[object] = [0, 0, 0, *range(1, len(properties) + 1)]
        names = ["float x", "float y", "float z", *properties]
        document = read(write(tmp_path / "a.ply", encoded("ascii", [("vertex", names, [row] * 3)])))
        values = document.parts[0].quality
        return None if values is None else values.tolist()

    assert quality("float confidence", "double quality") == [2, 2, 2]
    assert quality("float confidence", "int quality") == [1, 1, 1]
    assert quality("uchar quality", "float intensity") is None


@pytest.mark.parametrize("newline", [b"\n", b"\r\n", b"\r"])
@pytest.mark.parametrize("format_", FORMATS)
def test_a_file_that_has_not_moved_is_the_same_to_the_byte(
    format_: str, newline: bytes, tmp_path: Path
) -> None:
    content = encoded(format_, decorated(), ["comment  \u00e9t\u00e9 ", "obj_info x"])
    head, end, data = content.partition(b"end_header\n")
    header = (head + end).replace(b"element face", b"comment caf\xe9\nelement face")
    data = data.replace(b"\n", newline) if format_ == "ascii" else data
    path = write(tmp_path / "a.ply", header.replace(b"\n", newline) + data + b"\nrest")
    document = read(path)
    after = document.parts[0].vertices.copy()
    assert saved(document, tmp_path / "b.ply", after) == (path.read_bytes(), [])


@pytest.mark.filterwarnings("ignore:loadtxt")  # plyfile, of an empty list in a text
@pytest.mark.parametrize("format_", FORMATS)
def test_only_coordinates_and_normals_change(format_: str, tmp_path: Path) -> None:
    path = write(tmp_path / "a.ply", encoded(format_, decorated(), ["comment by hand"]))
    document = read(path)
    after = stretched(document)
    content, warnings = saved(document, tmp_path / "b.ply", after)
    assert warnings == []
    assert content.partition(b"end_header")[0] == path.read_bytes().partition(b"end_header")[0]
    old, new = PlyData.read(str(path)), PlyData.read(str(tmp_path / "b.ply"))
    np.testing.assert_array_equal(np.column_stack([new["vertex"][axis] for axis in "xyz"]), after)
    normals = np.column_stack([new["vertex"][f"n{axis}"] for axis in "xyz"])
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
    assert (np.abs(normals[:, 2]) < np.sqrt(1 / 3)).all()  # those of a higher box
    for element in old:
        for one in element.properties:
            if element.name != "vertex" or one.name[-1] not in "xyz":
                pairs = zip(element[one.name], new[element.name][one.name], strict=True)
                assert all(np.array_equal(a, b) for a, b in pairs)


def test_normals_of_hard_edges_stay_hard(tmp_path: Path) -> None:
    corners = [CORNERS[i] for quad in QUADS for i in quad]
    flat = [
        np.cross(b - a, c - a)
        for a, b, c, _ in (np.array([CORNERS[i] for i in quad]) for quad in QUADS)
    ]
    names = [f"double {axis}" for axis in ("x", "y", "z", "nx", "ny", "nz")]
    rows = [[*p, *flat[i // 4].tolist()] for i, p in enumerate(corners)]
    polygons = [[4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3] for i in range(6)]
    elements: list[Element] = [("vertex", names, [list(row) for row in rows]), faces(polygons)]
    document = read(write(tmp_path / "a.ply", encoded("binary_little_endian", elements)))
    saved(document, tmp_path / "b.ply", stretched(document))
    data = PlyData.read(str(tmp_path / "b.ply"))["vertex"]
    normals = np.column_stack([data[f"n{axis}"] for axis in "xyz"])
    np.testing.assert_allclose(normals, np.repeat(flat, 4, axis=0), atol=1e-15)


def test_in_a_text_only_the_words_that_moved_are_other_words(tmp_path: Path) -> None:
    content = (
        b"ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty int id\r\nproperty float x\r\n"
        b"property float y\r\nproperty float z\r\nelement face 1\r\n"
        b"property list uchar int vertex_indices\r\nend_header\r\n"
        b"7  0.000 1e0\t 2.50 \r\n\r\n  8 1 0 0\r\n9 0 +1 0\r\n3 0 1 2\r\n# the end"
    )
    document = read(write(tmp_path / "a.ply", content))
    after = document.parts[0].vertices.copy()
    after[0, 1], after[2, 0] = 1.25, -1 / 3
    result, _ = saved(document, tmp_path / "b.ply", after)
    expected = content.replace(b"1e0\t", b"1.25\t").replace(b"9 0 +1", b"9 -0.333333333 +1")
    assert result == expected


@pytest.mark.parametrize("format_", FORMATS)
def test_coordinates_become_double_where_single_does_not_hold_the_movement(
    format_: str, tmp_path: Path
) -> None:
    points = (np.array(CORNERS) + 500000).tolist()
    elements = [vertices(points=points), faces(HALVES)]
    document = read(write(tmp_path / "scan.ply", encoded(format_, elements)))
    after = document.parts[0].vertices + np.linspace(0.001, 0.002, 24).reshape(8, 3)
    content, warnings = saved(document, tmp_path / "b.ply", after)
    assert len(warnings) == 1
    assert "double precision, since single precision rounds" in warnings[0]
    assert "choose" not in warnings[0]
    assert content.count(b"property double") == 3
    again = read(tmp_path / "b.ply")
    np.testing.assert_array_equal(again.parts[0].vertices, after)
    np.testing.assert_array_equal(again.parts[0].faces, HALVES)


@pytest.mark.parametrize("format_", FORMATS)
def test_integer_coordinates_become_double(format_: str, tmp_path: Path) -> None:
    points = [[int(c) for c in corner] for corner in CORNERS]
    elements: list[Element] = [vertices("short", points), faces(HALVES)]  # type: ignore[arg-type]
    document = read(write(tmp_path / "a.ply", encoded(format_, elements)))
    after = document.parts[0].vertices * 0.75
    _, warnings = saved(document, tmp_path / "b.ply", after)
    assert "integers" in warnings[0]
    np.testing.assert_array_equal(read(tmp_path / "b.ply").parts[0].vertices, after)


CUBE = encoded("ascii", [vertices(), faces(HALVES)])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (b"ply\n", b"Dear all,\n", "no PLY header"),
        (b"end_header", b"end", "no PLY header"),
        (b"format ascii 1.0\n", b"", "line 2"),
        (b"float y", b"floot y", "line 5"),
        (b"float y", b"float w", "vertices have no y"),
        (b"vertex 8", b"vertex -8", "-8"),
        (b"vertex 8", b"vertex many", "many"),
        (b"vertex 8", b"vertex 2000000000", "element 'vertex': row 20"),
        (b"face 12", b"face 99999999999999999999", "element 'face': row 12"),
        (b"element face", b"element nothing 2000000000\nelement face", ""),
        (b"1.0 0.0 0.0\n", b"1.0 0.0\n", "element 'vertex': row 1"),
        (b"1.0 0.0 0.0\n", b"1.0 0.0 0.0 0.0\n", "element 'vertex': row 1"),
        (b"1.0 0.0 0.0\n", b"1.0 0.0 0\0\n", "element 'vertex': row 1"),
        (b"1.0 0.0 0.0\n", b"1.0 0.0 nan\n", "vertex 1"),
        (b"1.0 0.0 0.0\n", b"1.0 0.0 1e999\n", "vertex 1"),
        (b"\n3 0 3 1\n", b"\n3 0 3 8\n", "element 'face': row 1: it refers to vertex 8"),
        (b"\n3 0 3 1\n", b"\n3 0 3 -1\n", "element 'face': row 1"),
        (b"\n3 0 3 1\n", b"\n3 0 3 1e300\n", "element 'face': row 1"),
        (b"\n3 0 3 1\n", b"\n3 0 3 0.5\n", "element 'face': row 1"),
        (b"\n3 0 3 1\n", b"\n2000000000 0 3 1\n", "element 'face': row 1"),
        (b"\n3 0 3 1\n", b"\n-3 0 3 1\n", "element 'face': row 1"),
        (b"\n3 0 3 1\n", b"\nthree 0 3 1\n", "element 'face': row 1: 'three'"),
        (b"list uchar", b"list float", "no integer"),
    ],
)
def test_a_damaged_text_is_refused_with_the_place(
    old: bytes, new: bytes, words: str, tmp_path: Path
) -> None:
    assert CUBE.count(old) == 1
    path = write(tmp_path / "a.ply", CUBE.replace(old, new))
    if not words:
        assert len(read(path).parts[0].faces) == 12
        return
    with pytest.raises(MeshFileError, match=r"a\.ply.*") as error:
        read(path)
    assert words in str(error.value)


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize("polygons", [HALVES, [*HALVES[:6], *QUADS[3:]]])
def test_a_file_cut_off_anywhere_is_refused(
    polygons: list[list[int]], format_: str, tmp_path: Path
) -> None:
    content = encoded(format_, [vertices(), faces(polygons)])
    for size in range(0, len(content) - 2, 7):
        with pytest.raises(MeshFileError, match="damaged or cut off"):
            read(write(tmp_path / "a.ply", content[:size]))


@pytest.mark.parametrize("format_", FORMATS[1:])
@pytest.mark.parametrize("name", ["vertex", "face", "other"])
def test_a_count_that_does_not_fit_the_file_is_refused_at_once(
    name: str, format_: str, tmp_path: Path
) -> None:
    other: Element = ("other", ["int n"], [[1]])
    content = encoded(format_, [vertices(), faces(HALVES), other])
    count = {"vertex": b"8", "face": b"12", "other": b"1"}[name]
    element = b"element " + name.encode() + b" "
    damaged = content.replace(element + count, element + b"2000000000")
    with pytest.raises(MeshFileError, match=f"element '(face|{name})': row"):
        read(write(tmp_path / "a.ply", damaged))


@pytest.mark.parametrize("format_", FORMATS)
def test_random_damage_is_refused_or_read(format_: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    content = encoded(format_, decorated())
    for _ in range(300):
        damaged = bytearray(content)
        for place in rng.integers(len(content), size=3):
            damaged[place] = rng.integers(256)
        path = write(tmp_path / "a.ply", bytes(damaged))
        try:
            document = read(path)
        except MeshFileError:
            continue
        assert (document.parts[0].faces < len(document.parts[0].vertices)).all()
        assert saved(document, tmp_path / "b.ply", document.parts[0].vertices)[0] == bytes(damaged)


def test_a_range_grid_without_faces_is_not_read_as_points(tmp_path: Path) -> None:
    grid: Element = ("range_grid", ["list uchar int vertex_indices"], [[[0]], [[]]])
    path = write(tmp_path / "a.ply", encoded("ascii", [vertices(), grid]))
    with pytest.raises(MeshFileError, match="range grid"):
        read(path)


def test_textures_are_copied_beside_the_file_and_never_elsewhere(tmp_path: Path) -> None:
    for name in ("in/maps", "out/scratch"):
        (tmp_path / name).mkdir(parents=True)
    for name in ("in/my skin.png", "in/maps/b.png", "secret.png"):
        (tmp_path / name).write_bytes(name.encode())
    names = ["my skin.png", "maps/b.png", "../secret.png", str(tmp_path / "secret.png"), "no.png"]
    notes = [f"comment TextureFile {name}" for name in names]
    content = encoded("ascii", [vertices(), faces(HALVES)], notes)
    document = read(write(tmp_path / "in/a.ply", content))
    target = tmp_path / "out/scratch/a.ply"
    _, warnings = saved(document, target, document.parts[0].vertices)
    assert [warning.split(",")[0] for warning in warnings] == names[2:]
    found = [path for path in (tmp_path / "out").rglob("*") if path.is_file()]
    assert sorted(found) == sorted([target, *(target.parent / name for name in names[:2])])
    assert (target.parent / "maps/b.png").read_bytes() == b"in/maps/b.png"
    assert saved(document, target, document.parts[0].vertices)[1] == warnings  # the same are there


def test_textures_stay_where_they_are_beside_the_source(tmp_path: Path) -> None:
    (tmp_path / "scratch").mkdir()
    (tmp_path / "skin.png").write_bytes(b"skin")
    for folder in (tmp_path, tmp_path / "scratch"):
        assert copy_side_files(tmp_path / "a.ply", folder / "b.ply", ["skin.png", "no.png"]) == []
    assert not (tmp_path / "scratch" / "skin.png").exists()


def test_a_side_file_replaces_no_other_file(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "out/scratch").mkdir(parents=True)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "in/maps").mkdir()
    for name in ("in/b.ply", "in/maps/c.png"):
        (tmp_path / name).write_bytes(b"side file")
    target = write(tmp_path / "out/scratch/b.ply", b"mesh")
    (tmp_path / "out/scratch/maps").symlink_to(tmp_path / "elsewhere")
    names = ["b.ply", "maps/c.png", "x" * 5000, "nul\0", "", "C:\\d.png", "maps"]
    warnings = copy_side_files(tmp_path / "in/a.ply", target, names)
    assert len(warnings) == len(names)
    assert target.read_bytes() == b"mesh"
    assert list((tmp_path / "elsewhere").iterdir()) == []


@pytest.mark.skipif(not FIELD.is_dir(), reason="the files that users brought are not here")
@pytest.mark.parametrize("name", ["extra_properties", "uv_seam_split", "triangle_soup"])
def test_files_that_users_brought_keep_what_they_hold(name: str, tmp_path: Path) -> None:
    path = FIELD / f"{name}.ply"
    document = read(path)
    content, _ = saved(document, tmp_path / "b.ply", document.parts[0].vertices)
    assert content == path.read_bytes()
    saved(document, tmp_path / "b.ply", document.parts[0].vertices * 1.25)
    old, new = PlyData.read(str(path)), PlyData.read(str(tmp_path / "b.ply"))
    for one in old["vertex"].properties:
        if one.name not in ("x", "y", "z", "nx", "ny", "nz"):
            np.testing.assert_array_equal(old["vertex"][one.name], new["vertex"][one.name])
    np.testing.assert_allclose(new["vertex"]["x"], 1.25 * old["vertex"]["x"], rtol=1e-6)
