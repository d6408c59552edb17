"""In an OFF file only the numbers of moved vertices and of their normals change."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from meshlab_spectral.documents.document import Array
from meshlab_spectral.documents.off import Lines, read
from meshlab_spectral.errors import MeshFileError

V = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
FACES = b"3 0 1 2\n3 0 2 3\n"
PLAIN = b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + FACES
ALL = (
    b"# seen from above\r\nSTCNOFF # all of it\r\n\r\n4 2 5\r\n"
    b"0 0 0  0 0 1  255 0 0 255  .5 .5\r\n"
    b"\t1 0 0  0 0 1  255 0 0 255  .5 .5 # the second\r\n\r\n"
    b"1 1 0  0 0 1  255 0 0 255  .5 .5\r\n"
    b"0 1 0  0 0 1  255 0 0 255  .5 .5\r\n"
    b"3  0 1 2  0.5 0.5 0\r\n3  0 2 3  255 0 0\r\n"
)
VARIANTS = {
    "plain": PLAIN,
    "all": ALL,
    "counts in the first line": PLAIN.replace(b"OFF\n", b"OFF "),
    "two counts": PLAIN.replace(b"4 2 0", b"4 2"),
    "two vertices in a line": PLAIN.replace(b"0\n1 1", b"0 1 1"),
    "a vertex in two lines": PLAIN.replace(b"1 1 0", b"1\n1 0"),
    "more than coordinates": PLAIN.replace(b"1 1 0", b"1 1 0 7").replace(b"0 1 0", b"0 1 0 7"),
    "colours of one number": b"COFF\n4 2 0\n0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0\n" + FACES,
    "no last end of line": PLAIN[:-1],
    "lines": PLAIN.replace(b"4 2", b"4 3") + b"2 0 1\n",
}


def write(tmp_path: Path, content: bytes) -> Path:
    path = tmp_path / "in.off"
    path.write_bytes(content)
    return path


def saved(path: Path, moved: Array | None = None) -> bytes:
    document = read(path)
    target = path.with_name("out.off")
    assert document.save(target, [document.parts[0].vertices if moved is None else moved]) == []
    return target.read_bytes()


@pytest.mark.parametrize("name", VARIANTS)
def test_every_variant_is_read_and_stays_as_it_is(name: str, tmp_path: Path) -> None:
    path = write(tmp_path, VARIANTS[name])
    (part,) = read(path).parts
    np.testing.assert_array_equal(part.vertices, V)
    np.testing.assert_array_equal(part.faces, [[0, 1, 2], [0, 2, 3]])
    assert saved(path) == VARIANTS[name]


def test_what_a_file_holds_is_told(tmp_path: Path) -> None:
    held = ["normals", "colours", "texture coordinates", "face colours", "comments"]
    assert read(write(tmp_path, ALL)).contents == held
    assert read(write(tmp_path, PLAIN)).contents == []


def test_only_the_numbers_of_moved_vertices_and_their_normals_change(tmp_path: Path) -> None:
    path = write(tmp_path, ALL)
    moved = read(path).parts[0].vertices.copy()
    moved[1, 2] = 0.5
    written = saved(path, moved)
    before, after = (text.split(b"\r\n") for text in (ALL, written))
    changed = [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    assert changed == [4, 5, 7]  # the vertices of the triangle that has moved
    for i in changed:
        assert after[i].split()[6:] == before[i].split()[6:]
        normal = np.array(after[i].split()[3:6], dtype=float)
        assert np.linalg.norm(normal) == pytest.approx(1)
    words = after[5].split(b" ")
    assert words[:3] == [b"\t1", b"0", b"0.5"]
    expected = np.cross([1, 0, 0.5], [1, 1, 0])  # of the only triangle of vertex 1
    np.testing.assert_allclose(
        np.array(after[5].split()[3:6], dtype=float), expected / np.linalg.norm(expected), atol=1e-8
    )


def test_polygons_become_triangles(tmp_path: Path) -> None:
    content = PLAIN.replace(FACES, b"4 0 1 2 3 255 0 0\n1 3\n")
    document = read(write(tmp_path, content))
    np.testing.assert_array_equal(document.parts[0].faces, [[0, 1, 2], [0, 2, 3]])
    assert document.contents == ["face colours", "polygons", "lines and points"]


def test_a_cow_is_read_as_meshlab_reads_it(samples: Path, tmp_path: Path) -> None:
    path = tmp_path / "cow.off"
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(samples / "cow.obj"))
    mesh_set.save_current_mesh(str(path))
    mesh_set.load_new_mesh(str(path))
    (part,) = read(path).parts
    np.testing.assert_array_equal(part.vertices, mesh_set.current_mesh().vertex_matrix())
    np.testing.assert_array_equal(part.faces, mesh_set.current_mesh().face_matrix())
    assert saved(path) == path.read_bytes()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "first word is not OFF"),
        (PLAIN[4:], "first word is not OFF"),
        (b"OFF", "ends after its first line"),
        (b"OFF BINARY\n\0\0\0\4", "binary OFF.*save it as OFF"),
        (b"4OFF\n1 0 0\n0 0 0 1\n", "three coordinates.*save it as OFF"),
        (b"nOFF\n3\n1 0 0\n0 0 0\n", "three coordinates.*save it as OFF"),
        (b"OFF\n4\n", "line 2 has less than 2 numbers"),
        (b"OFF\nfour 2 0\n", "line 2 has 'four' where an integer"),
        (PLAIN.replace(b"4 2", b"4000000000 2"), "claims 4000000000 vertices"),
        (PLAIN.replace(b"4 2", b"-4 2"), "claims -4 vertices"),
        (PLAIN.replace(b"4 2", b"4 4000000000"), "and 4000000000 faces"),
        (PLAIN.replace(b"4 2", b"4 -2"), "and -2 faces"),
        (PLAIN[:-12], "claims 2 faces, and has 1 lines"),
        (PLAIN[:30], "claims 4 vertices and 2 faces, and has 10 numbers"),
        (VARIANTS["colours of one number"][:-16], "ends before the last of 4 vertices"),
        (ALL.replace(b"4 2 5", b"7 2 5"), "ends before the last of 7 vertices"),
        (b"NOFF\n3 0 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n", "ends before the last of 3 vertices"),
        (PLAIN.replace(b"1 1 0", b"1 inf 0"), "vertex 2 is at 1 inf 0"),
        (PLAIN.replace(b"1 1 0", b"1 1 O"), "line 5 has 'O' where a number"),
        (PLAIN.replace(b"3 0 2", b"9 0 2"), "line 8 has '9' where the number of the corners"),
        (PLAIN.replace(b"3 0 2", b"-1 0 2"), "line 8 has '-1'"),
        (PLAIN.replace(b"0 2 3", b"0 2 4"), "line 8 has '4' where one of 4 vertices"),
        (PLAIN.replace(b"0 2 3", b"0 2 1.5"), "line 8 has '1.5' where an integer"),
        (VARIANTS["colours of one number"].replace(b"1 1 0 1", b"1 1"), "line 5 has less than 3"),
    ],
)
def test_a_damaged_or_unknown_file_is_refused(content: bytes, message: str, tmp_path: Path) -> None:
    path = write(tmp_path, content)
    with pytest.raises(MeshFileError, match=message) as error:
        read(path)
    assert str(path) in str(error.value)


def test_numbers_are_read_to_the_last_bit() -> None:
    """Whatever program has written them."""
    rng = np.random.default_rng(1)
    values = np.concatenate(
        [
            rng.normal(0, 1, 500),
            rng.uniform(-1e7, 1e7, 500),
            rng.normal(0, 1, 500) * 10.0 ** rng.integers(-30, 30, 500),
            rng.integers(-9, 9, 100),
        ]
    )
    forms = ["%.6f", "%.9g", "%.17g", "%r", "%e", "%.12E", "%+.4f"]
    words = [form % value for form in forms for value in values.tolist()]
    words += ["1.", "-.5", ".5", "1e5", "-0", "-0.0", "1.e+02", "1e+005", "1E22"]
    words += ["9007199254740993", "1234567890123456789"]
    lines = Lines(Path("x"), " ".join(words).encode())
    read_ = lines.numbers(np.arange(len(words)))
    assert read_.tobytes() == np.array([float(word) for word in words]).tobytes()


@pytest.mark.parametrize("word", ["-", ".", "1..2", "--1", "e+05", "1e+-5", "1e+0.", "1,5", "1x"])
def test_what_is_no_number_is_named(word: str) -> None:
    lines = Lines(Path("x"), f"1\n2 {word} 3".encode())
    with pytest.raises(MeshFileError, match=re.escape(f"line 2 has '{word}' where")):
        lines.numbers(np.arange(4))
