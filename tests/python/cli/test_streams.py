"""Meshes on standard input and output, and what is in the way of an output."""

from __future__ import annotations

import errno
import io
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from commands import COMMAND, PRECIOUS, assert_fails, command, succeeded
from meshlab_spectral.cli.__main__ import buffer_output


def piped(*arguments: object, mesh: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    words = [*COMMAND, *map(str, arguments)]
    return subprocess.run(words, input=mesh, capture_output=True, timeout=120, check=False)


@pytest.mark.parametrize("verb", ["filter", "denoise"])
def test_standard_streams_have_the_bytes_of_files(verb: str, cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.obj"
    succeeded(verb, cow, target)
    done = piped(verb, "-", "-", "--format", "obj", mesh=cow.read_bytes())
    assert done.returncode == 0, done.stderr
    assert done.stdout == target.read_bytes()
    assert piped(verb, cow, "-", "--format", ".obj").stdout == target.read_bytes()
    other = tmp_path / "other.obj"
    done = piped(verb, "-", other, "--format", "obj", mesh=cow.read_bytes())
    assert (done.returncode, b"\nv " in done.stdout) == (0, False), done.stderr
    assert other.read_bytes() == target.read_bytes()


def test_a_stream_without_a_mesh_is_called_standard_input() -> None:
    done = piped("filter", "-", "-", "--format", "obj", mesh=b"no mesh")
    assert done.returncode == 1
    assert done.stderr.startswith(b"Error: standard input is not OBJ")
    assert done.stdout == b""


@pytest.mark.parametrize("verb", ["filter", "denoise"])
def test_an_output_is_replaced_only_on_request(verb: str, cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.ply"
    target.write_bytes(PRECIOUS)
    assert_fails(command(verb, cow, target), 2, f"{target} exists", "--overwrite")
    assert target.read_bytes() == PRECIOUS
    succeeded(verb, cow, target, "--overwrite")
    assert target.read_bytes() != PRECIOUS


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is full")
def test_a_full_disk_is_an_error_without_a_traceback(cow: Path) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [*COMMAND, "info", str(cow)],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 1
    assert "standard output cannot be written" in done.stderr
    assert "Traceback" not in done.stderr


class _SmallDisk(io.RawIOBase):
    """A file that takes three bytes at a time, and a hundred in all."""

    def __init__(self, room: int) -> None:
        self.room, self.content = room, b""

    def writable(self) -> bool:
        return True

    def write(self, data: bytes) -> int:  # type: ignore[override]
        taken = bytes(data[: min(3, self.room - len(self.content))])
        if not taken:
            raise OSError(errno.ENOSPC, "No space left on device")
        self.content += taken
        return len(taken)


@pytest.mark.parametrize("room", [1000, 100])
def test_unbuffered_output_is_written_whole_or_an_error(
    room: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As with PYTHONUNBUFFERED=1, usual in containers: Python would drop what is not taken."""
    disk = _SmallDisk(room)
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(disk, "utf-8", write_through=True))  # type: ignore[arg-type]
    buffer_output()
    mesh = bytes(range(250))

    def write() -> None:
        shutil.copyfileobj(io.BytesIO(mesh), sys.stdout.buffer)
        print("that is all")
        sys.stdout.flush()

    if room > len(mesh):
        write()
        assert disk.content == mesh + b"that is all\n"
        return
    with pytest.raises(OSError, match="No space left"):
        write()


def test_a_mesh_on_unbuffered_output_is_whole(cow: Path) -> None:
    words = [sys.executable, "-u", *COMMAND[1:], "denoise", str(cow), "-", "--format", "obj"]
    done = subprocess.run(words, capture_output=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == piped("denoise", cow, "-", "--format", "obj").stdout
