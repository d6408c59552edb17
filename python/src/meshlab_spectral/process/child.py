"""The program of the child process: `python -m meshlab_spectral.process.child FD`.

It reads jobs from standard input, one JSON object per line, and answers each on standard output
with JSON lines: {"stage": ...} as the work proceeds, then {"report": ...} with the peak memory, or
{"error": ...}. MeshLab's own output goes to standard error.

It ends at the end of its input, and immediately, whatever MeshLab is doing, when the pipe FD is
closed: it never outlives its parent.
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
from meshlab_spectral.filters.spectrum import measure
from meshlab_spectral.filters.tables import TABLES
from meshlab_spectral.plugin.memory import set_memory_limit

# In every error of the plugin about memory.
_TOO_MUCH_MEMORY = re.compile(r"memory, (of which )?\S+ \w+ are free")
_PEAK = re.compile(r"^VmHWM:\s+(\d+) kB$", re.MULTILINE)


def _report_of(job: dict[str, Any], on_stage: StageCallback) -> dict[str, Any]:
    """Do a job."""
    source, task = Path(job["source"]), job["task"]
    verbose = job.get("verbose", True)  # the log has the progress within a mesh
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
    options = TABLES[task].from_dict(job["options"])
    return filter_to_scratch(source, scratch, options, on_stage, verbose)


def _end_with_parent(lifeline: int) -> None:
    """Have the kernel end this process when the other end of a pipe is closed.

    A thread could not: MeshLab holds the interpreter lock while it works.
    """
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    # From here on, closing the pipe raises SIGIO, which by default ends the process.
    flags = fcntl.fcntl(lifeline, fcntl.F_GETFL)
    fcntl.fcntl(lifeline, fcntl.F_SETFL, flags | os.O_ASYNC)
    if select.select([lifeline], [], [], 0)[0]:  # already closed
        os._exit(1)


def _reset_peak_memory() -> None:
    with contextlib.suppress(OSError):  # Linux only
        Path("/proc/self/clear_refs").write_text("5")


def _peak_memory() -> int:
    """Peak memory in bytes since it was last reset, or else since the process started."""
    with contextlib.suppress(OSError):
        found = _PEAK.search(Path("/proc/self/status").read_text())
        if found:
            return 1024 * int(found[1])
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _described(error: Exception) -> dict[str, str]:
    """Describe an error by its class and message."""
    if isinstance(error, errors.SpectralError):
        if _TOO_MUCH_MEMORY.search(str(error)):
            return {"error": "MemoryLimitError", "message": str(error)}
        return {"error": type(error).__name__, "message": str(error)}
    message = f"unexpected error: {error}; please report it"
    if isinstance(error, MemoryError):
        message = (
            "the mesh needs more memory than available; if it is not that large, the file is "
            "damaged and declares more than it holds"
        )
    return {"error": "FilterError", "message": message}


def _main() -> None:
    # Ctrl-C reaches every process of the terminal; the parent handles it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _end_with_parent(int(sys.argv[1]))
    # Keep C++ output out of the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    os.dup2(2, 1)

    def answer(**content: Any) -> None:
        answers.write(json.dumps(content) + "\n")

    for line in sys.stdin:
        _reset_peak_memory()
        try:
            job = json.loads(line)
            set_memory_limit(job.get("memory"))
            report = _report_of(job, lambda stage: answer(stage=stage))
            answer(report=report, peak_memory=_peak_memory())
        except Exception as error:
            answer(**_described(error), traceback=traceback.format_exc().strip())
    answers.flush()
    # Skip the interpreter's shutdown, in which pymeshlab may crash after an error.
    os._exit(0)


if __name__ == "__main__":
    _main()
