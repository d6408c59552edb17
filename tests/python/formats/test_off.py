"""In an OFF file only the numbers of moved vertices and of their normals change."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import pyvista
from helpers import loaded
from hypothesis import given, settings
from hypothesis import strategies as st
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.document import Array
from meshlab_spectral.formats.off import read

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
    "small letters": PLAIN.replace(b"OFF", b"off"),
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


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_vertices_and_faces_may_stand_in_any_lines(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    letters = data.draw(st.sampled_from(["", "N", "C", "ST", "CN", "STCN"]))
    extra = {"N": [0, 0, 1], "C": [255, 0, 9, 255], "ST": [0.5, 0.25]}
    row = [word for letter in ("N", "C", "ST") if letter in letters for word in extra[letter]]
    words = [str(word) for point in V for word in [*point, *row]]
    colour = data.draw(st.sampled_from(["", " 255 0 9", " 0.5 0.5 0.5 1"]))
    gaps = st.sampled_from([" ", "  ", "\n", "\r\n", " # why not\n", "\n\n\t"])
    head = data.draw(st.sampled_from([f"{letters}OFF", f"# a square\n{letters}OFF"]))
    counts = data.draw(st.sampled_from(["4 2 0\n", " 4 2 5\n", "\n4 2 5 # counts\n"]))
    text = head + counts + "".join(word + data.draw(gaps) for word in words)
    if colour:  # which ends its line
        text = f"{text.rstrip()}\n3 0 1 2{colour}\n3 0 2 3{colour}\n"
    else:
        text += "".join(word + data.draw(gaps) for word in "30123023")
    path = write(tmp_path_factory.mktemp("off"), text.encode())
    (part,) = read(path).parts
    np.testing.assert_array_equal(part.vertices, V)
    np.testing.assert_array_equal(part.faces, [[0, 1, 2], [0, 2, 3]])
    assert saved(path) == text.encode()
    moved = part.vertices.copy()
    moved[3] += [0.25, 0, 0]
    again = path.with_name("again.off")
    again.write_bytes(saved(path, moved))
    np.testing.assert_array_equal(read(again).parts[0].vertices, moved)
    before, after = (re.split(rb"(#[^\n]*|\s+)", one.read_bytes()) for one in (path, again))
    assert len(before) == len(after)
    changed = [k for k, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    assert [after[k] for k in changed] == [b"0.25"]


@pytest.mark.parametrize("has_texture", [False, True])
@pytest.mark.parametrize("colours", ["RGBA", "RGB", "grey", "floats"])
@pytest.mark.parametrize("order", ["normals first", "colours first"])
def test_normals_follow_and_colours_stay_whichever_come_first(
    order: str, colours: str, has_texture: bool, tmp_path: Path
) -> None:
    """Geomview writes normals first, MeshLab colours."""
    sphere = pyvista.Icosphere(nsub=2)
    points, N = np.asarray(sphere.points, float), np.asarray(sphere.point_normals, float)
    rng = np.random.default_rng(4)
    shades = {
        "RGBA": np.append(rng.integers(0, 256, (len(N), 3)), np.full((len(N), 1), 255), axis=1),
        "RGB": rng.integers(0, 256, (len(N), 3)),
        "grey": np.repeat(rng.integers(0, 256, (len(N), 1)), 3, axis=1),
        "floats": rng.random((len(N), 3)).round(3),
    }[colours]
    columns = [N, shades] if order == "normals first" else [shades, N]
    columns += [rng.random((len(N), 2)).round(3)] if has_texture else []
    rows = [" ".join(f"{x:.7g}" for x in row) for row in np.hstack([points, *columns]).tolist()]
    faces = [f"3 {a} {b} {c}" for a, b, c in np.asarray(sphere.faces).reshape(-1, 4)[:, 1:]]
    head = f"{'ST' if has_texture else ''}NCOFF\n{len(rows)} {len(faces)} 0"
    path = write(tmp_path, "\n".join([head, *rows, *faces, ""]).encode())
    squashed = read(path).parts[0].vertices * [1, 1, 0.5]
    lines = saved(path, squashed).decode().splitlines()[2 : 2 + len(rows)]
    after = np.array([line.split() for line in lines], float)
    first = 3 if order == "normals first" else 3 + shades.shape[1]
    expected = points / [1, 1, 0.5]  # of an ellipsoid
    expected /= np.linalg.norm(expected, axis=1)[:, None]
    assert ((after[:, first : first + 3] * expected).sum(axis=1) > 0.99).all()
    rest = np.delete(after, np.s_[first : first + 3], axis=1)[:, 3:]
    given_rest = np.hstack([shades, *columns[2:]])
    np.testing.assert_array_equal(rest, given_rest)


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
    mesh_set = loaded(samples / "cow.obj")
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
        (PLAIN.replace(b"0\n1 1", b"0 1 1")[:-2], "claims 4 .* in 5 lines"),
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
