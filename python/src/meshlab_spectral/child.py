"""The program of the child process: `python -m meshlab_spectral.child`.

It reads jobs from standard input, one JSON object per line, and answers each on standard output
with JSON lines: {"ready": true} once, then {"stage": ...} as the work proceeds, and {"report": ...}
or {"error": ...} at its end.
MeshLab's own output goes to standard error.

It ends at the end of its input, whatever MeshLab is doing: it never outlives its parent.
"""

from __future__ import annotations

import json
import os
import pickle
import queue
import signal
import sys
import threading
import traceback
from pathlib import Path
from typing import Any

from meshlab_spectral import _core, errors
from meshlab_spectral.files.comparison import compare
from meshlab_spectral.files.filtering import (
    filter_to_scratch,
    joined_to_scratches,
    script_to_scratch,
)
from meshlab_spectral.files.intent import intent_of
from meshlab_spectral.files.measures import basis_to_scratch, mesh_info, spectrum_of, texture_of
from meshlab_spectral.files.meshes import StageCallback
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.whole_files import file_trouble, is_disk_full
from meshlab_spectral.filters.tables import TABLES
from meshlab_spectral.formats.budget import guard_process
from meshlab_spectral.plugin.limits import name_memory_limit, set_memory_limit
from meshlab_spectral.tiles.tile import filter_tile


def _report_of(job: dict[str, Any], on_stage: StageCallback) -> dict[str, Any]:
    """Do a job, and return its report."""
    task = job["task"]
    if task == "tile":
        return filter_tile(Path(job["folder"]), job["tile"], job["decided"], on_stage)
    if task == "joined":
        sources, scratches = (list(map(Path, job[name])) for name in ("sources", "scratches"))
        table = TABLES[job["filter"]]
        return joined_to_scratches(sources, scratches, table.from_dict(job["options"]), on_stage)
    if task == "compare":
        on_stage("reading", None)
        found = compare(job["source"], job["other"], max_distance=job["max_distance"])
        return _sent(found if job["whole"] else found.without_arrays, job)
    request = Request.of_job(job)
    if task == "texture":
        return _sent(texture_of(request, on_stage), job)
    if task == "spectrum":
        return spectrum_of(request, on_stage)
    if task == "info":
        return mesh_info(request.source, on_stage, request.mesh)
    if "target" in job:
        return intent_of(request, Path(job["target"]), on_stage)
    scratch, verbose = Path(job["scratch"]), job.get("verbose", True)
    if task == "basis":
        return basis_to_scratch(request, scratch, on_stage)
    if task == "script":
        return script_to_scratch(request.source, scratch, job["script"], on_stage, verbose)
    return filter_to_scratch(request, scratch, on_stage, verbose)


def _sent(result: object, job: dict[str, Any]) -> dict[str, Any]:
    """Hand over a result with arrays in the file of a job, in place of a report."""
    Path(job["result"]).write_bytes(pickle.dumps(result))
    return {}


def _read(jobs: queue.SimpleQueue[str]) -> None:
    """Queue the jobs from standard input, and end the process at its end.

    A thread can do so although MeshLab cannot be interrupted: pymeshlab releases the GIL.
    """
    for line in sys.stdin:
        jobs.put(line)
    # Skip the interpreter's shutdown, which would wait for MeshLab.
    os._exit(0)


def _described(error: Exception, job: dict[str, Any]) -> dict[str, Any]:
    """Describe an error of a job by its class, message and code."""
    if isinstance(error, errors.SpectralError):
        described: dict[str, Any] = {"error": type(error).__name__, "message": str(error)}
        if isinstance(error, errors.FilterError):
            described |= {"code": error.code, "limit": error.limit}
        elif isinstance(error, errors.MeshFileError):
            described["code"] = error.code
        return described
    if isinstance(error, OSError) and error.strerror:
        code = "disk_full" if is_disk_full(error) else "not_written"
        name = Path(job.get("scratch") or job.get("source", "a file")).name
        return {"error": "MeshFileError", "message": file_trouble(error, name), "code": code}
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
            job = json.loads(jobs.get())
            set_memory_limit(job.get("memory"))
            name_memory_limit("the memory limit")  # the parent says which
            _core.set_memory_limit(job.get("memory") or 0)
            answer(report=_report_of(job, on_stage))
        except Exception as error:
            answer(**_described(error, job), traceback=traceback.format_exc().strip())


if __name__ == "__main__":
    _main()
