"""In an OBJ file only the numbers of moved vertices and of their normals change."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from helpers import loaded
from hypothesis import given, settings
from hypothesis import strategies as st
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.digits import rounding_loss
from meshlab_spectral.formats.document import Array
from meshlab_spectral.formats.obj import read

SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
SHADED = SQUARE + b"vn 0 0 1\nvn 0.0 0.0 1.0\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n"


def write(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


def raised(vertices: Array, which: int) -> Array:
    moved = vertices.copy()
    moved[which, 2] += 0.5
    return moved


def saved(path: Path, moved: Array | None = None) -> bytes:
    """Write a file into a folder of its own, by default with the coordinates that it has."""
    document = read(path)
    target = path.parent / "out" / path.name
    target.parent.mkdir(exist_ok=True)
    document.save(target, [document.parts[0].vertices if moved is None else moved])
    return target.read_bytes()


@pytest.mark.parametrize(
    "faces",
    [
        b"f 1 2 3\nf 1 3 4",
        b"f 1/7 2/7 3/7\nf 1/ 3/ 4/",
        b"f 1//1 2//2 3//3\nf 1/1/1 3/1/1 4/1/1",
        b"f -4 -3 -2\nf -4//-1 -2//-1 -1//-1",
        b"f 1 2 3 # as in 1/2\r\nf 1 3 4 #",
        b"\tf  1 2 \\\r\n 3\nf 1\\\n \\\n3 4\nl 1 2\np 3",
        b"f 1 2\nf 1 2 3\nf 1 3 4",
    ],
)
def test_every_kind_of_face_is_read_and_the_file_is_unchanged(faces: bytes, tmp_path: Path) -> None:
    content = SQUARE + b"vn 0 0 1\n" * 3 + faces
    path = write(tmp_path / "in.obj", content)
    (part,) = read(path).parts
    np.testing.assert_array_equal(part.vertices, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    np.testing.assert_array_equal(part.faces, [[0, 1, 2], [0, 2, 3]])
    assert part.name == ""
    assert saved(path) == content


def test_relative_indices_count_from_the_line_of_the_face(tmp_path: Path) -> None:
    content = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -1 -4 -2\nf 1 2 4"
    (part,) = read(write(tmp_path / "in.obj", content)).parts
    np.testing.assert_array_equal(part.faces, [[0, 1, 2], [3, 0, 2], [0, 1, 3]])


def test_polygons_become_triangles(tmp_path: Path) -> None:
    document = read(write(tmp_path / "in.obj", SQUARE + b"v -1 .5 0\nf 1 2 3 4\nf 1 2 3 4 5\n"))
    np.testing.assert_array_equal(
        document.parts[0].faces, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 3], [0, 3, 4]]
    )
    assert document.contents == ["polygons"]


@pytest.mark.parametrize("names", ["größe".encode("latin-1"), "表".encode("shift-jis")])
def test_names_and_comments_of_any_encoding_stay(names: bytes, tmp_path: Path) -> None:
    """In Shift-JIS the name ends in a backslash, which does not continue the line."""
    content = b"# " + names + b"\ng " + names + b"\no " + names + b"\n" + SQUARE
    content += b"usemtl " + names + b"\nf 1 2 3\n# v 9 9 9 \\\nf 1 3 4 #"
    path = write(tmp_path / "in.obj", content)
    document = read(path)
    assert len(document.parts[0].faces) == 2
    assert document.contents == ["materials", "groups", "object names", "comments"]
    assert saved(path) == content


def test_only_the_numbers_of_moved_coordinates_change(tmp_path: Path) -> None:
    content = b"v 0.000 0 0 1\r\nv\t1.0  +0 -0.0 255 0 0 # x\r\n  v 1  1e0 0\r\nf 1 2 3\r\n"
    path = write(tmp_path / "in.obj", content)
    moved = read(path).parts[0].vertices.copy()
    moved[1] = [1.0, 0.0, 0.25]
    moved[2] = [1.0, 1.5, 0.125]
    expected = content.replace(b"-0.0", b"0.25").replace(b"1e0 0", b"1.5 0.125")
    assert read(path).contents == ["colours"]
    assert saved(path, moved) == expected


def test_normals_follow_and_one_that_no_face_uses_stays(tmp_path: Path) -> None:
    path = write(tmp_path / "in.obj", SHADED)
    lines = saved(path, raised(read(path).parts[0].vertices, 1)).split(b"\n")
    normal = np.array(lines[4].split()[1:], dtype=float)
    expected = np.cross([1, 0, 0.5], [1, 1, 0])
    np.testing.assert_allclose(normal, expected / np.linalg.norm(expected), atol=1e-8)
    assert lines[5:] == SHADED.split(b"\n")[5:]  # of the unmoved triangle, and the rest


def test_normals_follow_where_only_some_faces_have_them(tmp_path: Path) -> None:
    content = SHADED.replace(b"1//2 3//2 4//2", b"1 3 4")
    path = write(tmp_path / "in.obj", content)
    before = content.split(b"\n")
    after = saved(path, raised(read(path).parts[0].vertices, 0)).split(b"\n")
    changed = [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    assert changed == [0, 4]


def test_numbers_have_the_digits_that_the_movement_needs(tmp_path: Path) -> None:
    path = write(tmp_path / "in.obj", b"v 441547.5 5121946.5 0\n" + SQUARE + b"f 1 2 3")
    moved = read(path).parts[0].vertices.copy()
    moved[0] += 1 / 3000
    saved(path, moved)
    written = read(tmp_path / "out" / "in.obj").parts[0].vertices
    np.testing.assert_array_equal(written, moved)


@pytest.mark.parametrize(("share", "is_told"), [(0.009, False), (0.011, True)])
def test_a_hundredth_of_the_movement_may_be_rounded_away(share: float, is_told: bool) -> None:
    before, after = np.zeros((4, 3)), np.ones((4, 3))
    assert (rounding_loss(before, after, lambda points: points + share) is not None) == is_told


def test_what_is_rounded_away_is_told_as_lengths_like_the_displacement() -> None:
    before, after = np.zeros((4, 3)), np.tile([3.0, 4.0, 0.0], (4, 1))
    told = rounding_loss(before, after, lambda points: points + np.array([0.6, 0.0, 0.8]))
    assert told is not None
    assert "near 4 by 1, while the filter moves vertices by 5 (" in told


@pytest.fixture
def textured(tmp_path: Path) -> Path:
    """A file with material libraries, whose textures are in several folders."""
    folder = tmp_path / "in"
    (folder / "maps").mkdir(parents=True)
    for name in ("my skin.png", "maps/bump.png", "maps/fine.png", "b.jpg"):
        (folder / name).write_bytes(name.encode())
    (folder / "my model.mtl").write_bytes(
        b"newmtl a\r\nmap_Kd my skin.png\r\nmap_Ka maps/bump.png\r\n"
        b"  map_Bump -bm 0.5 -o 1 2.0 -1e0 -clamp on  maps\\bump.png\r\nmap_aat on\r\n"
        b"bump -s 1 1 3 b.jpg\r\nKd 1 1 1\r\nmap_d\r\nnorm ../outside.png\r\n"
    )
    (folder / "maps" / "b.mtl").write_bytes(b"MAP_KD fine.png\nmap_Ks gone.png")
    content = b"mtllib my model.mtl\nmtllib maps/b.mtl gone.mtl\n" + SQUARE + b"f 1 2 3\n"
    return write(folder / "in.obj", content)


def test_materials_and_textures_are_copied(textured: Path, tmp_path: Path) -> None:
    document = read(textured)
    target = tmp_path / "elsewhere" / "deep" / "out.obj"
    target.parent.mkdir(parents=True)
    warnings = document.save(target, [document.parts[0].vertices])
    copied = {str(path.relative_to(target.parent)) for path in target.parent.rglob("*.*")}
    there = {str(path.relative_to(textured.parent)) for path in textured.parent.rglob("*.*")}
    assert copied == there - {"in.obj"} | {"out.obj"}
    assert target.read_bytes() == textured.read_bytes()
    assert [warning.split(",")[0] for warning in warnings] == [
        "../outside.png",
        "maps/gone.png",
        "gone.mtl",
    ]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"Dear all,\nplease find the scan attached.\n", "no vertices"),
        (SQUARE + b"v 1 2\n", "row 4 is 'v 1 2', which lacks"),
        (SQUARE + b"v 1,0 2 3\n", "row 4 is 'v 1,0 2 3'"),
        (SQUARE + b"v 1 nan 3\n", "vertex 4 is at 1 nan 3"),
        (SQUARE + b"v 1 2 \\\n x\n", "row 4 is 'v 1 2"),
        (SQUARE + b"vn 0 1\n", "row 0 is 'vn 0 1'"),
        (SQUARE + b"f 1 2 3\nf 1 2 5\n", "face in line 6"),
        (SQUARE + b"f 1 2 0\n", "face in line 5"),
        (SQUARE.replace(b"\n", b"\r\n") + b"f 1 2 0\r\n", "face in line 5"),
        (SQUARE + b"f 1 2 -5\n", "face in line 5"),
        (SQUARE + b"f 1 2 x/1/1\n", "'x'"),
        (SQUARE + b"f 1 2 99999999999999999999\n", "too large"),
        (SQUARE + b"f 1 2 3/1/\xff\n", "xff"),
    ],
)
def test_a_damaged_file_is_refused(content: bytes, message: str, tmp_path: Path) -> None:
    path = write(tmp_path / "in.obj", content)
    with pytest.raises(MeshFileError, match=message) as error:
        read(path)
    assert str(path) in str(error.value)


def test_a_bunny_is_read_as_meshlab_reads_it_and_only_its_vertices_change(
    samples: Path, tmp_path: Path
) -> None:
    path = Path(shutil.copyfile(samples / "bunny10k_textured.obj", tmp_path / "in.obj"))
    mesh_set = loaded(path)
    (part,) = read(path).parts
    np.testing.assert_array_equal(part.vertices, mesh_set.current_mesh().vertex_matrix())
    np.testing.assert_array_equal(part.faces, mesh_set.current_mesh().face_matrix())
    assert saved(path) == path.read_bytes()
    moved = part.vertices + np.random.default_rng(1).normal(0, 1e-3, part.vertices.shape)
    lines = saved(path, moved).split(b"\n")
    for before, after in zip(path.read_bytes().split(b"\n"), lines, strict=True):
        assert before == after or (before[:2] == after[:2] and before[:2] in (b"v ", b"vn"))
    written = np.array([line.split()[1:] for line in lines if line.startswith(b"v ")], dtype=float)
    np.testing.assert_allclose(written[:, :3], moved, rtol=1e-8, atol=1e-12)


continued = st.sampled_from([" ", "  ", "\t", " \\\n ", "\\\r\n", " \\ \n\t", "\\ # why not\n"])


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_vertices_faces_and_normals_may_go_on_in_the_next_line(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    rows = SHADED.decode().split("\n")
    lines = [
        words[0] + " " + "".join(word + data.draw(continued) for word in words[1:-1]) + words[-1]
        for words in (row.split() for row in rows if row)
    ]
    text = "\n".join([*lines, ""]).encode()
    folder = tmp_path_factory.mktemp("obj")
    path, plain = write(folder / "in.obj", text), write(folder / "plain.obj", SHADED)
    (part,), (expected,) = read(path).parts, read(plain).parts
    np.testing.assert_array_equal(part.vertices, expected.vertices)
    np.testing.assert_array_equal(part.faces, expected.faces)
    assert saved(path) == text
    after = raised(part.vertices, 2)
    split = re.compile(rb"((?:\\ # why not\n|\\?\s)+)")
    new, given_ = split.split(saved(path, after)), split.split(text)
    assert new[1::2] == given_[1::2]  # what is between the words
    assert split.sub(b" ", saved(path, after)).split() == saved(plain, after).split()


@pytest.mark.parametrize("line", [r"mtllib .\a.mtl", r"mtllib maps\a.mtl", 'mtllib "maps/a.mtl"'])
@pytest.mark.parametrize("texture", [r"textures\t.png", '"textures/t.png"', r".\textures\t.png"])
def test_names_with_the_slashes_of_windows_are_found(
    line: str, texture: str, tmp_path: Path
) -> None:
    folder = tmp_path / ("maps" if "maps" in line else ".")
    (folder / "textures").mkdir(parents=True)
    (folder / "textures" / "t.png").write_bytes(b"an image")
    (folder / "a.mtl").write_text(f"newmtl m\nmap_Kd {texture}\n")
    path = write(tmp_path / "in.obj", f"{line}\n".encode() + SQUARE + b"f 1 2 3\n")
    document = read(path)
    target = tmp_path / "elsewhere" / "out" / "in.obj"
    target.parent.mkdir(parents=True)
    assert document.save(target, [document.parts[0].vertices]) == []
    copied = target.parent / folder.relative_to(tmp_path)
    assert (copied / "a.mtl").is_file()
    assert (copied / "textures" / "t.png").read_bytes() == b"an image"


def test_a_normal_that_serves_faces_which_turn_apart_becomes_several(tmp_path: Path) -> None:
    """A strip of four squares with one normal, as exporters write that save equal ones once."""
    vertices = b"".join(b"v %d %d 0\n" % (x, y) for x in range(5) for y in range(2))
    normals = b"vn 0 0 1 # up\nvn 0 1 0\n"
    faces = b"".join(
        b"f %d//1 %d//1 %d//1 %d//-2 # %d\n" % (2 * k + 1, 2 * k + 3, 2 * k + 4, 2 * k + 2, k)
        for k in range(4)
    )
    path = write(tmp_path / "in.obj", vertices + normals + b"g strip\n" + faces + b"l 1 2\n")
    document = read(path)
    (part,) = document.parts
    moved = part.vertices.copy()
    moved[:, 2] = 0.25 * moved[:, 0] ** 2
    target = tmp_path / "out.obj"
    (warning,) = document.save(target, [moved])
    assert warning == "4 normals are added, as others serve faces that turn apart"
    written = [line.partition(b"#")[0].split() for line in target.read_bytes().splitlines()]
    N = np.array([words[1:] for words in written if words[0] == b"vn"], float)
    assert len(N) == 2 + 4
    np.testing.assert_array_equal(N[-1], [0, 1, 0])
    np.testing.assert_allclose(np.linalg.norm(N, axis=1), 1, atol=1e-6)
    corners = [w.split(b"//") for words in written if words[0] == b"f" for w in words[1:]]
    for vertex, normal in corners:
        x = moved[int(vertex) - 1, 0]
        slope = 0.25 if x == 0 else 1.75 if x == 4 else 0.5 * x  # of the chords, in the mean
        angle = np.arctan2(-N[int(normal) - 1][0], N[int(normal) - 1][2])
        assert angle == pytest.approx(np.arctan(slope), abs=0.06)
    others = [w for w in written if w[0] in (b"g", b"l")]
    assert others == [[b"g", b"strip"], [b"l", b"1", b"2"]]
    assert b"# up" in target.read_bytes()
    assert read(target).contents == document.contents


def test_a_normal_of_two_faces_becomes_two(tmp_path: Path) -> None:
    content = (
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 3 0 0\nv 2 1 0\nvn 0 0 1\n"
        b"f 1//1 2//1 3//1\nf 4//1 5//1 6//1\n"
    )
    document = read(write(tmp_path / "in.obj", content))
    moved = document.parts[0].vertices.copy()
    moved[4, 2] = 1
    (warning,) = document.save(tmp_path / "out.obj", [moved])
    assert warning == "1 normal is added, as others serve faces that turn apart"
    lines = [line.split() for line in (tmp_path / "out.obj").read_text().splitlines()]
    N = np.array([words[1:] for words in lines if words[0] == "vn"], float)
    corners = [[w.split("//")[1] for w in words[1:]] for words in lines if words[0] == "f"]
    assert [len(set(one)) for one in corners] == [1, 1]
    of_faces = N[[int(one[0]) - 1 for one in corners]]
    np.testing.assert_allclose(of_faces, [[0, 0, 1], [-(0.5**0.5), 0, 0.5**0.5]], atol=1e-6)
