"""In an OFF file only the numbers of moved vertices and of their normals change."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from meshlab_spectral.documents.document import Array
from meshlab_spectral.documents.off import read
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
HELD = {
    "all": ["normals", "colours", "texture coordinates", "face colours", "comments"],
    "polygon": ["face colours", "polygons"],
}
VARIANTS = {
    "plain": PLAIN,
    "all": ALL,
    "counts in the first line": PLAIN.replace(b"OFF\n4 2 0", b"OFF 4 2"),
    "more than coordinates": PLAIN.replace(b"1 1 0", b"1 1 0 7").replace(b"0 1 0", b"0 1 0 7"),
    "polygon": PLAIN.replace(FACES, b"4 0 1 2 3 255 0 0\n1 3\n"),
    "no last end of line": PLAIN[:-1],
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
def test_every_variant_is_read_and_stays_unchanged(name: str, tmp_path: Path) -> None:
    path = write(tmp_path, VARIANTS[name])
    (part,) = read(path).parts
    np.testing.assert_array_equal(part.vertices, V)
    np.testing.assert_array_equal(part.faces, [[0, 1, 2], [0, 2, 3]])
    assert saved(path) == VARIANTS[name]
    assert read(path).contents == HELD.get(name, [])


def test_only_the_numbers_of_moved_vertices_and_their_normals_change(tmp_path: Path) -> None:
    path = write(tmp_path, ALL)
    moved = read(path).parts[0].vertices.copy()
    moved[1, 2] = 0.5
    before, after = (text.split(b"\r\n") for text in (ALL, saved(path, moved)))
    changed = [i for i, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    assert changed == [4, 5, 7]  # the vertices of the triangle that has moved
    for i in changed:
        assert after[i].split()[6:] == before[i].split()[6:]
    assert after[5].startswith(b"\t1 0 0.5  ")
    expected = np.cross([1, 0, 0.5], [1, 1, 0])  # of the only triangle of vertex 1
    normal = np.array(after[5].split()[3:6], dtype=float)
    np.testing.assert_allclose(normal, expected / np.linalg.norm(expected), atol=1e-8)


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
        (b"Dear all,\n", "is not OFF .its first word is not OFF"),
        (b"OFF BINARY\n\0\0\0\4", "is binary.*save it as PLY"),
        (b"4OFF\n1 0 0\n0 0 0 1\n", "vertices other than x y z"),
        (PLAIN.replace(b"0\n1 1", b"0 1 1")[:-2], "cannot be read as OFF"),
        (PLAIN.replace(b"4 2", b"4000000000 2"), "claims 4000000000 vertices"),
        (PLAIN.replace(b"4 2", b"-4 2"), "claims -4 vertices"),
        (PLAIN[:-16], "claims 4 vertices and 2 faces, in 4 lines"),
        (PLAIN.replace(b"1 1 0", b"1 inf 0"), "vertex 2 is at 1 inf 0"),
        (PLAIN.replace(b"1 1 0", b"1 1 O"), "row 2 is '1 1 O'"),
        (PLAIN.replace(b"3 0 2", b"9 0 2"), "fewer corners than it claims"),
        (PLAIN.replace(b"0 2 3", b"0 2 4"), r"face 1 has the corners \[0, 2, 4\]"),
        (PLAIN.replace(b"3 0 2 3", b"4 0 2 3 9"), r"face 2 has the corners \[0, 3, 9\]"),
    ],
)
def test_a_damaged_or_unknown_file_is_refused(content: bytes, message: str, tmp_path: Path) -> None:
    path = write(tmp_path, content)
    with pytest.raises(MeshFileError, match=message) as error:
        read(path)
    assert str(path) in str(error.value)
