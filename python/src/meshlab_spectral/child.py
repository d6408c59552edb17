"""The program of the child process: `python -m meshlab_spectral.child`.

It reads jobs from standard input, one per line, and answers each on standard output with JSON
lines: {"ready": true} once, then {"stage": ...} as the work proceeds, and {"report": ...} or
{"error": ...} at its end. Jobs and errors are pickled, as `as_text` of `workers.process` does, a
slow import. MeshLab's own output goes to standard error.

It ends at the end of its input, whatever MeshLab is doing: it never outlives its parent.
"""

from __future__ import annotations

import base64
import json
import os
import pickle
import queue
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from meshlab_spectral import _core
from meshlab_spectral.errors import FilterError, MeshFileError, SpectralError
from meshlab_spectral.files.filtering import filter_to_scratch, joined_to_scratches
from meshlab_spectral.files.intent import intent_of
from meshlab_spectral.files.measures import (
    basis_to_scratch,
    comparison_of,
    mesh_info,
    spectrum_of,
    texture_of,
)
from meshlab_spectral.files.whole_files import file_trouble, is_disk_full
from meshlab_spectral.formats.budget import guard_process
from meshlab_spectral.plugin.limits import name_memory_limit, set_memory_limit
from meshlab_spectral.tiles.tile import filter_tile

# What a job may call: each takes the entries of the job by name, and `on_stage`.
_CALLS: dict[str, Callable[..., Any]] = {
    one.__name__: one
    for one in (
        basis_to_scratch,
        comparison_of,
        filter_tile,
        filter_to_scratch,
        intent_of,
        joined_to_scratches,
        mesh_info,
        spectrum_of,
        texture_of,
    )
}


def _read(jobs: queue.SimpleQueue[str]) -> None:
    """Queue the jobs from standard input, and end the process at its end.

    A thread can do so although MeshLab cannot be interrupted: pymeshlab releases the GIL.
    """
    for line in sys.stdin:
        jobs.put(line)
    # Skip the interpreter's shutdown, which would wait for MeshLab.
    os._exit(0)


def _told(error: Exception, job: dict[str, Any]) -> SpectralError:
    """Return an error of a job as one of this package's."""
    if isinstance(error, SpectralError):
        return error
    if isinstance(error, OSError) and error.strerror:
        code = "disk_full" if is_disk_full(error) else "not_written"
        source = getattr(job.get("request"), "source", "a file")
        return MeshFileError(file_trouble(error, Path(job.get("scratch", source)).name), code)
    if isinstance(error, MemoryError):
        return FilterError(
            "the mesh needs more memory than available; if it is not that large, the file is "
            "damaged and declares more than it holds"
        )
    return FilterError(f"unexpected error: {error}; please report it")


def _main() -> None:
    # Ctrl-C reaches every process of the terminal; the parent handles it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    guard_process()
    # Keep C++ output out of the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    os.dup2(2, 1)

    def answer(**content: Any) -> None:
        answers.write(json.dumps(content) + "\n")

    def on_stage(stage: str, fraction: float | None) -> None:
        answer(stage=stage, fraction=fraction)

    answer(ready=True)
    jobs: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_read, args=[jobs], daemon=True).start()
    job: dict[str, Any] = {}
    while True:
        try:
            job = pickle.loads(base64.b64decode(jobs.get()))
            memory, file, call = (job.pop(name, None) for name in ("memory", "result", "call"))
            set_memory_limit(memory)
            name_memory_limit("the memory limit")  # the parent says which
            _core.set_memory_limit(memory or 0)
            report = _CALLS[call](**job, on_stage=on_stage)
            if file is not None:  # for what has arrays
                file.write_bytes(pickle.dumps(report))
            answer(report=report if file is None else {})
        except Exception as error:
            told = base64.b64encode(pickle.dumps(_told(error, job))).decode()
            answer(error=told, traceback=traceback.format_exc().strip())


if __name__ == "__main__":
    _main()
