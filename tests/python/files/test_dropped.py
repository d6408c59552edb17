"""A vertex that is not finite is named: MeshLab would drop it with its faces, without a word."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from commands import assert_fails, command, write_ply
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.dropped import check_nothing_dropped

V = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"]
F = ["0 2 1", "0 1 3", "0 3 2", "1 2 3"]
BROKEN = 2  # first of the corners of face 3 but one


def with_value(value: str) -> list[str]:
    return [f"0 {value} 0" if i == BROKEN else v for i, v in enumerate(V)]


def ascii_ply(path: Path, vertices: list[str]) -> None:
    write_ply(path, "\n".join(vertices), "\n".join(f"3 {face}" for face in F))


def binary_ply(path: Path, vertices: list[str], order: str = "little") -> None:
    sign = "<" if order == "little" else ">"
    header = (
        f"ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty double x\n"
        "property uchar red\nproperty double y\nproperty double z\nelement face 4\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    rows = [list(map(float, vertex.split())) for vertex in vertices]
    content = b"".join(struct.pack(sign + "dBdd", x, 7, y, z) for x, y, z in rows)
    faces = b"".join(struct.pack(sign + "B3i", 3, *map(int, face.split())) for face in F)
    path.write_bytes(header.encode() + content + faces)


def big_endian_ply(path: Path, vertices: list[str]) -> None:
    binary_ply(path, vertices, "big")


def obj(path: Path, vertices: list[str]) -> None:
    faces = [" ".join(str(int(corner) + 1) for corner in face.split()) for face in F]
    lines = [f"v {vertex}" for vertex in vertices] + [f"f {face}" for face in faces]
    path.write_text("# a comment\n" + "\n".join(lines) + "\n")


def off(path: Path, vertices: list[str]) -> None:
    lines = ["OFF", "# a comment", "4 4 0", *vertices, *(f"3 {face}" for face in F)]
    path.write_text("\n".join(lines) + "\n")


def triangles(vertices: list[str]) -> list[list[str]]:
    return [[vertices[int(corner)] for corner in face.split()] for face in F]


def ascii_stl(path: Path, vertices: list[str]) -> None:
    facets = [
        "facet normal nan nan nan\nouter loop\n"
        + "".join(f"  vertex {corner}\n" for corner in triangle)
        + "endloop\nendfacet\n"
        for triangle in triangles(vertices)
    ]
    path.write_text("solid x\n" + "".join(facets) + "endsolid x\n")


def binary_stl(path: Path, vertices: list[str]) -> None:
    content = b""
    for triangle in triangles(vertices):
        corners = np.array([corner.split() for corner in triangle], dtype="<f4")
        content += bytes(12) + corners.tobytes() + bytes(2)
    path.write_bytes(bytes(80) + struct.pack("<I", len(F)) + content)


WRITERS = {
    "ascii.ply": ascii_ply,
    "binary.ply": binary_ply,
    "big endian.ply": big_endian_ply,
    "m.obj": obj,
    "m.off": off,
    "ascii.stl": ascii_stl,
    "binary.stl": binary_stl,
}


@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
@pytest.mark.parametrize("name", WRITERS)
def test_the_vertex_that_was_dropped_is_named(name: str, value: str, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path, with_value(value))
    named = "corner of triangle 0" if name.endswith(".stl") else "vertex 2"
    with pytest.raises(MeshFileError, match=f"{named} is at 0 {value} 0") as error:
        check_nothing_dropped(path, 3, 1)
    assert str(path) in str(error.value)


@pytest.mark.parametrize("name", ["ascii.ply", "ascii.stl"])
def test_a_number_beyond_the_files_precision_is_named(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path, with_value("1e39"))
    with pytest.raises(MeshFileError, match=r"1e\+39.*too large"):
        check_nothing_dropped(path, 3, 1)


@pytest.mark.parametrize("name", WRITERS)
def test_a_whole_mesh_is_none_of_these(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path, V)
    check_nothing_dropped(path, 4, 4)
    check_nothing_dropped(path, 3, 3)  # faces without area, or the like, were removed


@pytest.mark.parametrize("name", ["ascii.ply", "m.obj", "m.off", "binary.stl"])
def test_a_command_refuses_the_file(name: str, existing: Path, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path, with_value("nan"))
    assert_fails(command("filter", path, existing), 1, str(path), "nan", "not finite")
