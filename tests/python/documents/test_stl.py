"""In an STL file only the corners and normals of moved triangles change."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
from meshlab_spectral.documents.document import Array
from meshlab_spectral.documents.stl import read
from meshlab_spectral.errors import MeshFileError

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
TRIANGLES = [  # a pyramid; its last face has no area
    [[0, 0, 0], [1, 0, 0], [0.5, 0.5, 1]],
    [[1, 0, 0], [0.5, 1, 0], [0.5, 0.5, 1]],
    [[0.5, 1, 0], [0, 0, 0], [0.5, 0.5, 1]],
    [[0, 0, 0], [0.5, 1, 0], [1, 0, 0]],
    [[1, 0, 0], [1, 0, 0], [0, 0, 0]],
]
VERTICES = [[0, 0, 0], [1, 0, 0], [0.5, 0.5, 1], [0.5, 1, 0]]
FACES = [[0, 1, 2], [1, 3, 2], [3, 0, 2], [0, 3, 1], [1, 1, 0]]
BOTTOM, NO_AREA = 3, 4


def normals() -> Array:
    T = np.array(TRIANGLES, dtype=float)
    N = np.cross(T[:, 1] - T[:, 0], T[:, 2] - T[:, 0])
    N[NO_AREA] = [0, 0.6, 0.8]
    return np.asarray(N / np.linalg.norm(N, axis=1)[:, None])


def binary(header: bytes = b"solid as a text", attribute: int = 0, trailing: bytes = b"") -> bytes:
    rows = np.zeros(len(TRIANGLES), RECORD)
    rows["corners"], rows["normal"], rows["attribute"] = TRIANGLES, normals(), attribute
    return header.ljust(80) + struct.pack("<I", len(rows)) + rows.tobytes() + trailing


def ascii_(end: str = "\n", keyword: Callable[[str], str] = str.lower) -> bytes:
    """Two solids, the second of them with the last two triangles."""
    text = ["solid first of two"]
    for i, (normal, triangle) in enumerate(zip(normals(), TRIANGLES, strict=True)):
        text += ["endsolid first of two", "", "solid vertex"] if i == BOTTOM else []
        text += [keyword("\tfacet normal") + "  {:.6e} {:e} {:f}".format(*normal)]
        text += [keyword("outer loop")]
        text += [keyword("  vertex ") + "{:.3f}  {:e}\t{}".format(*corner) for corner in triangle]
        text += [keyword("endloop"), keyword("endfacet")]
    return end.join([*text, "endsolid", ""]).encode()


FILES = {
    "binary": binary(),
    "binary with attributes": binary(b"\xff", attribute=7),
    "binary with a little more": binary(b"COLOR=\0", trailing=bytes(9)),
    "text": ascii_(),
    "text in capitals": ascii_("\r\n", str.upper),
}
BINARIES = [name for name in FILES if name.startswith("binary")]
TEXTS = [name for name in FILES if name.startswith("text")]


def write(tmp_path: Path, content: bytes) -> Path:
    path = tmp_path / "in.stl"
    path.write_bytes(content)
    return path


def saved(path: Path, moved: Array | None = None) -> tuple[bytes, list[str]]:
    document = read(path)
    target = path.with_name("out.stl")
    warnings = document.save(target, [document.parts[0].vertices if moved is None else moved])
    return target.read_bytes(), warnings


def records(content: bytes) -> np.ndarray[tuple[int], np.dtype[np.void]]:
    return np.frombuffer(content, RECORD, len(TRIANGLES), 84)


def raised(path: Path, vertex: int) -> Array:
    moved = read(path).parts[0].vertices.copy()
    moved[vertex, 2] += 0.25
    return moved


@pytest.mark.parametrize("name", FILES)
def test_corners_that_coincide_are_one_vertex_and_the_file_stays_as_it_is(
    name: str, tmp_path: Path
) -> None:
    path = write(tmp_path, FILES[name])
    (part,) = read(path).parts
    np.testing.assert_array_equal(part.vertices, VERTICES)
    np.testing.assert_array_equal(part.faces, FACES)
    assert saved(path) == (FILES[name], [])


def test_what_a_file_holds_is_told(tmp_path: Path) -> None:
    expected = {"binary": [], "binary with attributes": ["attribute bytes"]}
    expected["text"] = ["names of solids"]
    for name, contents in expected.items():
        assert read(write(tmp_path, FILES[name])).contents == contents
    unnamed = ascii_().replace(b"solid first of two", b"solid").replace(b"solid vertex", b"solid")
    assert read(write(tmp_path, unnamed)).contents == []


def test_zeros_of_either_sign_are_one_place_and_keep_their_signs(tmp_path: Path) -> None:
    rows = np.zeros(2, RECORD)
    rows["corners"] = [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, -0.0, -0.0], [0, 1, 0], [-1, 0, 0]]]
    content = bytes(80) + struct.pack("<I", 2) + rows.tobytes()
    path = write(tmp_path, content)
    assert len(read(path).parts[0].vertices) == 4
    assert saved(path)[0] == content


@pytest.mark.parametrize("name", BINARIES)
def test_only_moved_corners_and_the_normals_of_their_triangles_change(
    name: str, tmp_path: Path
) -> None:
    path = write(tmp_path, FILES[name])
    content, warnings = saved(path, raised(path, 2))
    assert warnings == []
    assert len(content) == len(FILES[name])
    assert content[:84] == FILES[name][:84]
    assert content[84 + 50 * len(TRIANGLES) :] == FILES[name][84 + 50 * len(TRIANGLES) :]
    before, after = records(FILES[name]), records(content)
    np.testing.assert_array_equal(after["attribute"], before["attribute"])
    assert after[BOTTOM:].tobytes() == before[BOTTOM:].tobytes()
    top = after["corners"][:3, 2]
    np.testing.assert_array_equal(top, [[0.5, 0.5, 1.25]] * 3)
    T = after["corners"][:3].astype(float)
    expected = np.cross(T[:, 1] - T[:, 0], T[:, 2] - T[:, 0])
    expected /= np.linalg.norm(expected, axis=1)[:, None]
    np.testing.assert_allclose(after["normal"][:3], expected, atol=1e-6)


@pytest.mark.parametrize("name", TEXTS)
def test_only_numbers_of_moved_triangles_change_in_a_text(name: str, tmp_path: Path) -> None:
    path = write(tmp_path, FILES[name])
    content, _ = saved(path, raised(path, 2))
    before, after = (text.split(b"\n") for text in (FILES[name], content))
    changed = {a: b for a, b in zip(before, after, strict=True) if a != b}
    corner = next(line for line in before if b"0.500  5.000000e-01\t1" in line)
    assert changed.pop(corner) == corner.replace(b"\t1", b"\t1.25")
    assert len(changed) == 3  # the normals of the three sides
    for line, new in changed.items():
        assert new.split()[:2] == line.split()[:2]
        assert np.linalg.norm(np.array(new.split()[2:], dtype=float)) == pytest.approx(1)


def test_a_facet_without_normal_or_area_keeps_what_it_has(tmp_path: Path) -> None:
    content = bytearray(binary())
    records(content)["normal"][0] = 0  # type: ignore[arg-type]
    path = write(tmp_path, bytes(content))
    moved = read(path).parts[0].vertices + 0.25
    moved[0] = moved[1] = [0, 0, -1]
    after = records(saved(path, moved)[0])
    np.testing.assert_array_equal(after["normal"][0], 0)
    np.testing.assert_allclose(after["normal"][NO_AREA], [0, 0.6, 0.8], atol=1e-7)
    np.testing.assert_array_equal(after["normal"][BOTTOM], records(content)["normal"][BOTTOM])


def test_a_normal_stays_on_the_side_where_it_was(tmp_path: Path) -> None:
    rows = records(binary()).copy()
    rows["normal"] *= -1
    path = write(tmp_path, binary()[:84] + rows.tobytes())
    after = records(saved(path, raised(path, 2))[0])
    assert (np.einsum("ij,ij->i", after["normal"], rows["normal"]) > 0.9).all()


def test_a_binary_file_warns_of_what_single_precision_cannot_hold(tmp_path: Path) -> None:
    rows = records(binary()).copy()
    rows["corners"] += 5e6
    path = write(tmp_path, binary()[:84] + rows.tobytes())
    _, (warning,) = saved(path, read(path).parts[0].vertices + 1e-3)
    assert "single precision" in warning


def test_a_text_has_the_digits_that_the_movement_needs(tmp_path: Path) -> None:
    path = write(tmp_path, ascii_().replace(b"\t1.0", b"\t5121946.5").replace(b"\t1\n", b"\t6e6\n"))
    moved = read(path).parts[0].vertices + 1 / 3000
    saved(path, moved)
    np.testing.assert_array_equal(read(path.with_name("out.stl")).parts[0].vertices, moved)


@pytest.mark.parametrize("is_binary", [True, False])
def test_a_bone_is_read_as_meshlab_reads_it(is_binary: bool, samples: Path, tmp_path: Path) -> None:
    path = tmp_path / "bone.stl"
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(samples / "bone.ply"))
    mesh_set.save_current_mesh(str(path), binary=is_binary)
    mesh_set.load_new_mesh(str(path))
    mesh = mesh_set.current_mesh()
    corners = mesh.vertex_matrix()[mesh.face_matrix()]
    (part,) = read(path).parts
    np.testing.assert_allclose(part.vertices[part.faces], corners, rtol=1e-6)
    assert len(np.unique(part.vertices, axis=0)) == len(part.vertices)
    assert saved(path)[0] == path.read_bytes()


REFUSED = {
    "no triangles": (b"solid x\nendsolid x\n", "no triangles"),
    "empty": (b"", "no triangles"),
    "no lines": (3000 * b"x", "no triangles"),
    "binary without triangles": (bytes(84), "no triangles"),
    "many": (bytes(80) + struct.pack("<I", 4_000_000_000) + bytes(50), "4000000000 triangles"),
    "binary cut off": (binary()[:-1], "5 triangles, which does not fit its 333 bytes"),
    "much more": (binary(trailing=bytes(17)), "5 triangles"),
    "text cut off": (ascii_()[:-40], "three corners and an end"),
    "two corners": (ascii_().replace(b"vertex 0", b"edge 0", 1), "facet in line 2 has not three"),
    "corner before": (b"solid\nvertex 0 0 0\n" + ascii_(), "before the first facet"),
    "short corner": (ascii_().replace(b"\t1\n", b"\n", 1), "line 6 has less than 3 numbers"),
    "word": (ascii_().replace(b"\t1\n", b"\tone\n", 1), "line 6 has 'one' where a number"),
    "not finite": (ascii_().replace(b"\t1\n", b"\tnan\n", 1), "triangle 0 is at 0.5 0.5 nan"),
    "too large": (ascii_().replace(b"\t1\n", b"\t1e39\n", 1), r"triangle 0.*1e\+39.*too large"),
    "binary, not finite": (
        binary().replace(struct.pack("<f", 0.5), struct.pack("<f", np.inf), 1),
        "triangle 0 is at inf 0.5 1",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_damaged_file_is_refused(name: str, tmp_path: Path) -> None:
    content, message = REFUSED[name]
    path = write(tmp_path, content)
    with pytest.raises(MeshFileError, match=message) as error:
        read(path)
    assert str(path) in str(error.value)
