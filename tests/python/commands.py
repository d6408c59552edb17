"""What the tests of the command line need: running it, and files for it to read."""

from __future__ import annotations

import atexit
import io
import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pymeshlab

COMMAND = [sys.executable, "-m", "meshlab_spectral.cli"]
_WIDE = {"COLUMNS": "200"}
_SIZE = {"COLUMNS", "LINES"}  # of the terminal, which help alone reads when it is shown
PRECIOUS = b"precious bytes of a file that was here before\n"


class Worker:
    """Runs commands in forks of one process that has imported the package: see command_worker.py.

    A process of its own takes half a second to do so, which is most of what a command takes.
    """

    def __init__(self) -> None:
        self._settings = _python_settings()
        self._process = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("command_worker.py"))],
            env={**os.environ, **_WIDE},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    @property
    def id(self) -> int:
        """Of its process."""
        return self._process.pid

    def suits(self) -> bool:
        """Whether Python would start now as it did in the worker."""
        return self._process.poll() is None and self._settings == _python_settings()

    def run(
        self, words: list[str], folder: Path, timeout: float, size: dict[str, str]
    ) -> subprocess.CompletedProcess[str]:
        """Run a command with the environment of now, and a terminal's size."""
        environment = {**os.environ, **_WIDE, **size}
        request = {"words": words, "environment": environment, "folder": str(folder)}
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        if not select.select([self._process.stdout], [], [], timeout)[0]:
            os.killpg(self._process.pid, signal.SIGKILL)
            raise subprocess.TimeoutExpired(words, timeout)
        code, *texts = json.loads(self._process.stdout.readline())
        output, errors = (
            io.TextIOWrapper(
                io.BytesIO(text.encode("utf-8", "surrogateescape")), encoding="utf-8"
            ).read()
            for text in texts
        )
        return subprocess.CompletedProcess(words, code, output, errors)

    def end(self) -> None:
        """Let the worker end."""
        self._process.communicate()


def _python_settings() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name.startswith("PYTHON")}


_workers: list[Worker] = []


def is_worker(process: int) -> bool:
    """Whether a process is that of `worker`, which stays."""
    return any(process == one.id for one in _workers)


def worker() -> Worker | None:
    """Return the worker of these tests; None where a command needs a process of its own."""
    if not hasattr(os, "fork"):
        return None
    if not _workers:
        _workers.append(Worker())
        atexit.register(_workers[0].end)
    return _workers[0] if _workers[0].suits() else None


def command(
    *arguments: object, timeout: float = 120, folder: Path | None = None, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run a command; with variables of the environment, which imports may read, from scratch."""
    words = [str(argument) for argument in arguments]
    if environment.keys() <= _SIZE and (forking := worker()) is not None:
        return forking.run(words, folder or Path.cwd(), timeout, environment)
    return subprocess.run(
        [*COMMAND, *words],
        cwd=folder,
        env={**os.environ, **_WIDE, **environment},
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


def python(
    *arguments: object,
    timeout: float = 300,
    check: bool = False,
    preexec_fn: Callable[[], object] | None = None,
    **environment: str,
) -> subprocess.CompletedProcess[str]:
    """Run Python, with variables of the environment besides those that there are."""
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=timeout,
        check=check,
        preexec_fn=preexec_fn,
    )


def succeeded(*arguments: object, **environment: Any) -> subprocess.CompletedProcess[str]:
    """Run a command that must succeed."""
    done = command(*arguments, **environment)
    assert done.returncode == 0, done.stderr
    return done


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
