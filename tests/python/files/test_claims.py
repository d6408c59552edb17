"""Files that claim more than they hold are refused before MeshLab reads them, or hangs."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from commands import assert_fails, command, write_ply
from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.files.claims import check_claims

TRIANGLE = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 1, 0, 0)


def stl(count: int, content: bytes) -> bytes:
    return bytes(80) + struct.pack("<I", count) + content


def ply(format_: str, vertices: int, faces: int, content: bytes) -> bytes:
    return (
        f"ply\nformat {format_} 1.0\nelement vertex {vertices}\nproperty float x\n"
        f"property float y\nproperty float z\nelement face {faces}\n"
        "property list uchar int vertex_indices\nend_header\n"
    ).encode() + content


BINARY = "binary_little_endian"
CORNERS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
FACE = struct.pack("<B3i", 3, 0, 1, 2)
TEXT = b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2"
REFUSED = {
    "many triangles.stl": (stl(4_000_000_000, TRIANGLE), "4000000000 triangles"),
    "cut off.stl": (stl(40, 39 * TRIANGLE), "40 triangles"),
    "a text to MeshLab.stl": (stl(1, bytes(50) + b"   "), "1 triangles"),
    "no lines.stl": (3000 * b"x", "without lines"),
    "many vertices.ply": (ply(BINARY, 2 * 10**9, 1, CORNERS + FACE), "2000000000 vertex"),
    "many faces.ply": (ply(BINARY, 3, 3 * 10**8, CORNERS + FACE), "300000000 face"),
    "many in a text.ply": (ply("ascii", 3, 2 * 10**9, TEXT), "2000000000 face"),
}
WHOLE = {
    "whole.stl": stl(2, 2 * TRIANGLE),
    "with a little more.stl": stl(40, 40 * TRIANGLE + b"    "),
    "text.stl": b"solid x\nendsolid x\n" + 100 * b"\n",
    "whole.ply": ply(BINARY, 3, 1, CORNERS + FACE),
    "without the last end of line.ply": ply("ascii", 3, 1, TEXT),
    "no header.ply": b"ply\nelement vertex many\n",
    "other.obj": b"v 0 0 0\n",
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_claim_beyond_the_file_is_refused(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    content, claim = REFUSED[name]
    path.write_bytes(content)
    with pytest.raises(MeshFileError, match=claim) as error:
        check_claims(path)
    assert str(path) in str(error.value)
    assert "damaged" in str(error.value)


@pytest.mark.parametrize("name", WHOLE)
def test_a_file_that_may_be_whole_is_left_to_meshlab(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(WHOLE[name])
    check_claims(path)


def test_a_command_refuses_it_at_once(existing: Path, tmp_path: Path) -> None:
    path = tmp_path / "many triangles.stl"
    path.write_bytes(REFUSED[path.name][0])
    assert_fails(command("filter", path, existing), 1, str(path), "4000000000 triangles")


def test_an_ascii_ply_is_filtered(tmp_path: Path) -> None:
    path = write_ply(tmp_path / "in.ply", "0 0 0\n1 0 0\n0 1 0", "3 0 1 2")
    assert command("filter", path, tmp_path / "out.ply", "--steps", 1).returncode == 0
