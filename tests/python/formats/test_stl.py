"""In an STL file only the corners and normals of moved triangles change."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pymeshlab
import pytest
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.document import Array
from meshlab_spectral.formats.stl import read

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
TRIANGLES = [  # a pyramid with zeros of both signs; its last face has no area
    [[0, 0, 0], [1, 0, 0], [0.5, 0.5, 1]],
    [[1, 0, 0], [0.5, 1, 0], [0.5, 0.5, 1]],
    [[0.5, 1, 0], [0, -0.0, 0], [0.5, 0.5, 1]],
    [[0, 0, 0], [0.5, 1, 0], [1, 0, 0]],
    [[1, 0, 0], [1, 0, 0], [0, 0, 0]],
]
BOTTOM, NO_AREA = 3, 4


def normals_of(triangles: npt.ArrayLike) -> Array:
    T = np.array(triangles, dtype=float)
    N = np.cross(T[:, 1] - T[:, 0], T[:, 2] - T[:, 0])
    return np.asarray(N / np.linalg.norm(N, axis=1)[:, None])


NORMALS = np.vstack([normals_of(TRIANGLES[:NO_AREA]), [0, 0.6, 0.8]])


def binary(attribute: int = 0, trailing: bytes = b"", normals: Array = NORMALS) -> bytes:
    rows = np.zeros(len(TRIANGLES), RECORD)
    rows["corners"], rows["normal"], rows["attribute"] = TRIANGLES, normals, attribute
    return b"solid as a text".ljust(80) + struct.pack("<I", len(rows)) + rows.tobytes() + trailing


def ascii_(end: str = "\n", keyword: Callable[[str], str] = str.lower) -> bytes:
    """Two solids, the second of them with the last two triangles."""
    text = ["solid first of two"]
    for i, (normal, triangle) in enumerate(zip(NORMALS, TRIANGLES, strict=True)):
        text += ["endsolid first of two", "", "solid vertex"] if i == BOTTOM else []
        text += [keyword("\tfacet normal") + "  {:.6e} {:e} {:f}".format(*normal), "outer loop"]
        text += [keyword("  vertex ") + "{:.3f}  {:e}\t{}".format(*corner) for corner in triangle]
        text += [keyword("endloop"), keyword("endfacet")]
    return end.join([*text, "endsolid", ""]).encode()


FILES = {
    "binary": binary(),
    "binary with attributes": binary(attribute=7),
    "binary with a little more": binary(trailing=bytes(9)),
    "text": ascii_(),
    "text in capitals": ascii_("\r\n", str.upper),
}


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


def raised(path: Path) -> Array:
    moved = read(path).parts[0].vertices.copy()
    moved[moved[:, 2] == 1, 2] += 0.25
    return moved


@pytest.mark.parametrize("name", FILES)
def test_coincident_corners_are_one_vertex_and_the_file_is_unchanged(
    name: str, tmp_path: Path
) -> None:
    path = write(tmp_path, FILES[name])
    (part,) = read(path).parts
    assert len(part.vertices) == 4
    np.testing.assert_array_equal(part.vertices[part.faces], TRIANGLES)
    assert saved(path) == (FILES[name], [])
    contents = {"attributes": ["attribute bytes"], "text": ["names of solids"]}
    assert read(path).contents == next((contents[key] for key in contents if key in name), [])


@pytest.mark.parametrize("side", [1, -1])
def test_only_moved_corners_and_the_normals_of_their_triangles_change(
    side: int, tmp_path: Path
) -> None:
    content = binary(attribute=7, trailing=bytes(9), normals=side * NORMALS)
    path = write(tmp_path, content)
    written, _ = saved(path, raised(path))
    assert written[:84] + written[84 + 50 * BOTTOM :] == content[:84] + content[84 + 50 * BOTTOM :]
    sides = records(written)[:BOTTOM]
    assert (sides["attribute"] == 7).all()
    np.testing.assert_array_equal(sides["corners"][:, 2], [[0.5, 0.5, 1.25]] * 3)
    np.testing.assert_allclose(sides["normal"], side * normals_of(sides["corners"]), atol=1e-6)


@pytest.mark.parametrize("name", ["text", "text in capitals"])
def test_only_numbers_of_moved_triangles_change_in_a_text_file(name: str, tmp_path: Path) -> None:
    path = write(tmp_path, FILES[name])
    content, _ = saved(path, raised(path))
    before, after = (text.split(b"\n") for text in (FILES[name], content))
    changed = {a: b for a, b in zip(before, after, strict=True) if a != b}
    corner = next(line for line in before if b"0.500  5.000000e-01\t1" in line)
    assert changed.pop(corner) == corner.replace(b"\t1", b"\t1.25")
    assert len(changed) == 3  # the normals of the three sides
    assert all(new.split()[:2] == old.split()[:2] for old, new in changed.items())


def test_a_facet_without_normal_or_area_keeps_its_normal(tmp_path: Path) -> None:
    normals = NORMALS.astype(np.float32)
    normals[0] = 0
    path = write(tmp_path, binary(normals=normals))
    after = records(saved(path, -read(path).parts[0].vertices * [1, 1, 2])[0])
    np.testing.assert_array_equal(after["normal"][[0, NO_AREA]], normals[[0, NO_AREA]])


def test_a_binary_file_warns_of_what_single_precision_cannot_hold(tmp_path: Path) -> None:
    rows = records(binary()).copy()
    rows["corners"] += 5e6
    path = write(tmp_path, binary()[:84] + rows.tobytes())
    _, (warning,) = saved(path, read(path).parts[0].vertices + 1e-3)
    assert "single precision" in warning


@pytest.mark.parametrize("is_binary", [True, False])
def test_a_bone_is_read_as_meshlab_reads_it(is_binary: bool, samples: Path, tmp_path: Path) -> None:
    path, mesh_set = tmp_path / "bone.stl", pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(samples / "bone.ply"))
    mesh_set.save_current_mesh(str(path), binary=is_binary)
    mesh = mesh_set.current_mesh()
    (part,) = read(path).parts
    corners = mesh.vertex_matrix()[mesh.face_matrix()]
    np.testing.assert_allclose(part.vertices[part.faces], corners, rtol=1e-6)
    assert saved(path)[0] == path.read_bytes()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"solid none\nendsolid none\n", "no facets"),
        (bytes(80) + struct.pack("<I", 4_000_000_000) + bytes(50), "4000000000 triangles"),
        (binary()[:-1], "5 triangles, which does not match its 333 bytes"),
        (binary().replace(struct.pack("<f", 0.5), struct.pack("<f", np.inf), 1), "at inf 0.5 1"),
        (ascii_()[:-40], "ends within a facet"),
        (ascii_().replace(b"vertex 0", b"edge 0", 1), "line 8 does not begin with 'vertex'"),
        (ascii_().replace(b"\t1\n", b"\tone\n", 1), "row 2 is 'vertex 0.500 5.000000e-01 one'"),
        (ascii_().replace(b"\t1\n", b"\tnan\n", 1), "vertex 2 is at 0.5 0.5 nan"),
    ],
)
def test_a_damaged_file_is_refused(content: bytes, message: str, tmp_path: Path) -> None:
    path = write(tmp_path, content)
    with pytest.raises(MeshFileError, match=message) as error:
        read(path)
    assert str(path) in str(error.value)


def test_text_that_ends_between_facets_may_have_been_cut_off(tmp_path: Path) -> None:
    whole = ascii_()
    assert read(write(tmp_path, whole)).warnings == []
    cut = whole[: whole.index(b"endfacet") + len(b"endfacet\n")]
    (warning,) = read(write(tmp_path, cut)).warnings
    assert "ends without endsolid" in warning
