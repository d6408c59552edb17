"""Runs the command line, each time in a fork: `python command_worker.py`.

It reads requests from standard input, each a JSON object with the words of the command, the
variables of its environment and its folder, and answers each with a JSON line: exit code, what was
printed, and what was printed on standard error. Importing the package takes half a second; a fork,
nearly nothing.
"""

from __future__ import annotations

import json
import os
import runpy
import sys
import tempfile
from typing import IO, Any

# What every command imports, at once or when it parses its options; and what draws plots.
import filelock  # noqa: F401
import matplotlib.figure  # noqa: F401
import meshlab_spectral.cli.app  # noqa: F401
import psutil  # noqa: F401
import pydantic.type_adapter  # noqa: F401
import typer._adapters  # noqa: F401


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
    runpy.run_module("meshlab_spectral.cli", run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
