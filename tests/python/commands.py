"""What the tests of the command line need: running it, and files for it to read."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pymeshlab

COMMAND = [sys.executable, "-m", "meshlab_spectral.cli"]
PRECIOUS = b"precious bytes of a file that was here before\n"


def command(
    *arguments: object, timeout: float = 120, **environment: str
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *map(str, arguments)],
        env={**os.environ, "COLUMNS": "200", **environment},
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )


def command_on_terminal(*arguments: object) -> tuple[int, bytes, bytes]:
    """Exit code, standard output, and what a terminal on standard error is sent."""
    reader, terminal = pty.openpty()
    try:
        process = subprocess.Popen(
            [*COMMAND, *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=terminal,
            env={**os.environ, "COLUMNS": "120", "TERM": "xterm-256color"},
        )
        os.close(terminal)
        shown = b""
        while True:
            try:
                part = os.read(reader, 65536)
            except OSError:  # Linux's way to say that the last writer has gone
                break
            if not part:
                break
            shown += part
        stdout, _ = process.communicate(timeout=60)
    finally:
        os.close(reader)
    return process.returncode, stdout, shown


def messages_in(stderr: str) -> str:
    """Standard error without progress, of which a busy machine prints more."""
    return re.sub(r"^\[[^\]]+\] .*\n", "", stderr, flags=re.MULTILINE)


def assert_fails(done: subprocess.CompletedProcess[str], code: int, *words: str) -> None:
    """The exit code, one message with these words, no traceback, nothing on standard output."""
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert "LOG:" not in done.stderr
    for word in words:
        assert word in done.stderr
    if code == 1:
        assert len(messages_in(done.stderr).splitlines()) == 1


def write_ply(path: Path, vertices: str, faces: str) -> Path:
    V, F = vertices.splitlines(), faces.splitlines()
    path.write_text(
        f"ply\nformat ascii 1.0\nelement vertex {len(V)}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {len(F)}\nproperty list uchar int vertex_indices\n"
        "end_header\n" + "".join(line + "\n" for line in V + F)
    )
    return path


def arrays_of(path: Path) -> tuple[Any, Any]:
    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(path))
    mesh = mesh_set.current_mesh()
    return mesh.vertex_matrix().copy(), mesh.face_matrix().copy()
