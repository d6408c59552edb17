"""Runs the command line, each time in a fork: `python command_worker.py`.

It reads requests from standard input, each a JSON object with the words of the command, the
variables of its environment and its folder, and answers each with a JSON line: exit code, what was
printed, and what was printed on standard error. Importing the package takes half a second; a fork,
nearly nothing, where its collections leave alone what was imported.
"""

from __future__ import annotations

import atexit

# What every command imports, at once or when it parses its options; and what draws.
import email.message  # noqa: F401
import gc
import importlib.metadata  # noqa: F401
import json
import os
import runpy
import signal
import subprocess
import sys
import tempfile
import threading
from typing import IO, Any

import filelock  # noqa: F401
import matplotlib.backends.backend_agg
import matplotlib.figure
import matplotlib.pyplot  # noqa: F401
import meshlab_spectral.child
import meshlab_spectral.cli.app
import psutil  # noqa: F401
import pydantic.type_adapter  # noqa: F401
import typer._adapters  # noqa: F401
from small_pictures import draw_small

CHILD = [sys.executable, "-m", "meshlab_spectral.child"]


class _Popen(subprocess.Popen[Any]):
    """Starts MeshLab's process in a fork, too, where the command has no thread yet."""

    def _execute_child(self, args: Any, *given: Any) -> None:
        if args != CHILD or threading.active_count() > 1:
            super()._execute_child(args, *given)  # type: ignore[misc]
            return
        environment, ends = given[5], given[9:15]  # of three pipes, each to read and to write
        self.pid = os.fork()
        if self.pid == 0:
            try:
                for number, end in enumerate((ends[0], ends[3], ends[5])):
                    os.dup2(end, number)
                os.closerange(3, 256)
                os.environ.clear()
                os.environ.update(environment)
                signal.signal(signal.SIGTERM, signal.SIG_DFL)
                meshlab_spectral.child._main()
            finally:
                os._exit(1)
        self._child_created = True
        self._close_pipe_fds(*ends)  # type: ignore[attr-defined]


def _become(request: dict[str, Any], output: IO[bytes], errors: IO[bytes]) -> None:
    """Go on as `python -m meshlab_spectral.cli` begins."""
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(output.fileno(), 1)
    os.dup2(errors.fileno(), 2)
    os.environ.clear()
    os.environ.update(request["environment"])
    tempfile.tempdir = None  # known only from TMPDIR
    os.chdir(request["folder"])
    sys.path[0] = request["folder"]
    sys.argv[1:] = request["words"]


def main() -> None:
    """Answer requests until the end of the input."""
    # A collection at a fork's end would copy every page of what is shared: .3 s, not .07.
    gc.collect()
    gc.freeze()
    draw_small()
    subprocess.Popen = _Popen  # type: ignore[misc]
    for line in sys.stdin:
        with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
            child = os.fork()
            if child == 0:
                _become(json.loads(line), output, errors)
                break
            _, status = os.waitpid(child, 0)
            texts = []
            for file in (output, errors):
                file.seek(0)
                texts.append(file.read().decode("utf-8", "surrogateescape"))
        print(json.dumps([os.waitstatus_to_exitcode(status), *texts]), flush=True)
    else:
        return
    try:
        runpy.run_module("meshlab_spectral.cli", run_name="__main__", alter_sys=True)
    except SystemExit as end:
        if not isinstance(end.code, int):
            raise
        # As Python ends, but for taking apart what was imported.
        threading._shutdown()  # type: ignore[attr-defined]
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(end.code)


if __name__ == "__main__":
    main()
