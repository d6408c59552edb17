"""The program of the child process in which MeshLab works.

It is started as `python -m meshlab_spectral.process.child FD`.

It reads jobs from its standard input, one JSON object a line, and answers each on its standard
output with JSON lines: {"stage": ...} as the work goes on, then {"report": ...} with the peak of
the memory, or {"error": ...}. What MeshLab itself says goes to the standard error stream.

It ends when its standard input does, and at once, in the middle of whatever MeshLab does, when the
pipe FD is closed: its parent's death leaves no orphan.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import re
import resource
import select
import signal
import sys
import traceback
from pathlib import Path
from typing import Any

from meshlab_spectral import errors
from meshlab_spectral.files.basis import basis_to_scratch
from meshlab_spectral.files.meshes import (
    StageCallback,
    filter_to_scratch,
    load_arrays,
    script_to_scratch,
)
from meshlab_spectral.filters.calling import plain_report
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.spectrum import measure

_PEAK = re.compile(r"^VmHWM:\s+(\d+) kB$", re.MULTILINE)


def _report_of(job: dict[str, Any], on_stage: StageCallback) -> dict[str, Any]:
    """Do a job."""
    source, task = Path(job["source"]), job["task"]
    verbose = job.get("verbose", True)  # the log tells the progress within a mesh
    if task == "spectrum":
        on_stage("reading")
        V, F = load_arrays(source)
        on_stage("measuring")
        return plain_report(measure(V, F, job["parameters"], verbose=verbose))
    scratch = Path(job["scratch"])
    if task == "basis":
        return basis_to_scratch(source, scratch, **job["options"], on_stage=on_stage)
    if task == "script":
        return script_to_scratch(source, scratch, job["script"], on_stage, verbose)
    options = FilterOptions.from_dict(job["options"])
    return filter_to_scratch(source, scratch, options, on_stage, verbose)


def _end_with_parent(lifeline: int) -> None:
    """Have the kernel end this process when the other end of a pipe is closed.

    A thread that waits for it would have to wait for MeshLab, too, which holds the interpreter.
    """
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    # From here on the closing raises SIGIO, whose default is the end.
    flags = fcntl.fcntl(lifeline, fcntl.F_GETFL)
    fcntl.fcntl(lifeline, fcntl.F_SETFL, flags | os.O_ASYNC)
    if select.select([lifeline], [], [], 0)[0]:  # closed before that
        os._exit(1)


def _forget_peak_memory() -> None:
    with contextlib.suppress(OSError):  # only Linux can
        Path("/proc/self/clear_refs").write_text("5")


def _peak_memory() -> int:
    """Bytes that this process held at most since the peak was forgotten; else since its start."""
    with contextlib.suppress(OSError):
        found = _PEAK.search(Path("/proc/self/status").read_text())
        if found:
            return 1024 * int(found[1])
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _described(error: Exception) -> dict[str, str]:
    """Name an error by its kind and its message."""
    if isinstance(error, errors.SpectralError):
        return {"error": type(error).__name__, "message": str(error)}
    message = f"unexpected error: {error}; please report it"
    if isinstance(error, MemoryError):
        message = (
            "the mesh needs more memory than there is; if it is not that large, the file is "
            "damaged, and announces more than it holds"
        )
    return {"error": "FilterError", "message": message}


def _main() -> None:
    # Ctrl-C reaches every process of the terminal; the parent decides what it means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _end_with_parent(int(sys.argv[1]))
    # Whatever C++ prints must not come between the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    os.dup2(2, 1)

    def answer(**content: Any) -> None:
        answers.write(json.dumps(content) + "\n")

    for line in sys.stdin:
        _forget_peak_memory()
        try:
            report = _report_of(json.loads(line), lambda stage: answer(stage=stage))
            answer(report=report, peak_memory=_peak_memory())
        except Exception as error:
            answer(**_described(error), traceback=traceback.format_exc().strip())
    answers.flush()
    # Without the interpreter's tidying up, in which pymeshlab may crash after an error.
    os._exit(0)


if __name__ == "__main__":
    _main()
