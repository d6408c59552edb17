"""Runs the command line, each time in a fork: `python command_worker.py`.

It reads command lines from standard input, each a JSON list of strings, and answers each with a
JSON line: exit code, what was printed, and what was printed on standard error. Importing the
package takes half a second; a fork, nearly nothing.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from typing import IO

from meshlab_spectral.cli.app import app
from typer.main import get_command

_COMMAND = get_command(app)  # most of the time of a usage error


def _run(arguments: list[str], output: IO[bytes], errors: IO[bytes]) -> None:
    """Do as the command does, in this process; never return."""
    code = 0
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(output.fileno(), 1)
    os.dup2(errors.fileno(), 2)
    sys.argv = ["meshlab-spectral", *arguments]
    try:
        _COMMAND()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
    except BaseException:
        sys.excepthook(*sys.exc_info())
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def main() -> None:
    """Answer command lines until the end of the input."""
    for line in sys.stdin:
        with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
            child = os.fork()
            if child == 0:
                _run(json.loads(line), output, errors)
            _, status = os.waitpid(child, 0)
            texts = []
            for file in (output, errors):
                file.seek(0)
                texts.append(file.read().decode("utf-8", "replace"))
        print(json.dumps([os.waitstatus_to_exitcode(status), *texts]), flush=True)


if __name__ == "__main__":
    main()
