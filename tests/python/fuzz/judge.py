"""Gives examples to `worker.py`, in a process that is replaced when it crashes or hangs."""

from __future__ import annotations

import json
import os
import selectors
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

_WORKER = Path(__file__).with_name("worker.py")
_EXAMPLES_OF_A_PROCESS = 300  # each keeps its meshes


class Judge:
    """A child process that judges one example after the other.

    Parameters
    ----------
    seconds
        Limit for one example, which is run twice.
    """

    def __init__(self, seconds: float = 60) -> None:
        self._seconds = seconds
        self._child: subprocess.Popen[bytes] | None = None
        self._errors = tempfile.TemporaryFile("w+b")  # noqa: SIM115
        self._judged = 0

    def __call__(self, example: dict[str, Any]) -> dict[str, Any]:
        """Return the worker's answer; a crash, or no answer in time, is a failure."""
        if self._child is None or self._judged % _EXAMPLES_OF_A_PROCESS == 0:
            self._start()
        self._judged += 1
        child = self._child
        assert child is not None
        assert child.stdin is not None
        child.stdin.write(json.dumps(example).encode() + b"\n")
        child.stdin.flush()
        line = self._line()
        if line.endswith(b"\n"):
            answer: dict[str, Any] = json.loads(line)
            return answer
        self._stop()
        how = f"it took more than {self._seconds} seconds"
        if child.returncode not in (None, -9):
            self._errors.seek(0)
            tail = self._errors.read().decode("utf-8", "replace")[-1500:]
            how = f"the process ended with {child.returncode}: {tail}"
        return {"outcome": "none", "text": "", "warnings": [], "failures": [how]}

    def _line(self) -> bytes:
        assert self._child is not None
        assert self._child.stdout is not None
        line = b""
        with selectors.DefaultSelector() as selector:
            selector.register(self._child.stdout, selectors.EVENT_READ)
            while not line.endswith(b"\n"):
                if not selector.select(self._seconds):
                    self._child.kill()
                part = os.read(self._child.stdout.fileno(), 65536)
                if not part:
                    break
                line += part
        return line

    def _start(self) -> None:
        self._stop()
        self._errors.seek(0)
        self._errors.truncate()
        self._child = subprocess.Popen(
            [sys.executable, str(_WORKER)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
        )

    def end(self) -> None:
        """End the process; the judge cannot be used again."""
        self._stop()
        self._errors.close()

    def _stop(self) -> None:
        if self._child is None:
            return
        assert self._child.stdin is not None
        assert self._child.stdout is not None
        self._child.stdin.close()
        self._child.wait()
        self._child.stdout.close()
        self._child = None
