"""Processing of a file, or of several that are one surface, in a worker: errors become results."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from meshlab_spectral.batch import storage
from meshlab_spectral.batch.jobs import FileResult, Job, Outcome
from meshlab_spectral.errors import BatchError, ProcessStartError, SpectralError
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.whole_files import file_trouble, side_files
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.warned import Warned, warned, with_warnings
from meshlab_spectral.workers.processes import Processes, ProcessesEndedError


def run_job(processes: Processes, job: Job) -> FileResult:
    """Process one file; the outcome is "filtered", "unchanged", "measured" or "failed".

    Errors with a single file are not raised. Raises BatchError when no process starts, and
    ProcessesEndedError when the processes are ended meanwhile.
    """
    (result,) = _run(processes, [job], _alone)
    return result


def run_together(processes: Processes, jobs: Sequence[Job]) -> list[FileResult]:
    """Process files that are one surface, as `run_job` does one; if one fails, all do."""
    return _run(processes, jobs, _joined)


def _alone(request: Request, sources: list[Path], scratches: list[Path]) -> dict[str, Any]:
    """Return what is to be done with a file, for `MeshLabProcess.run`."""
    request = replace(request, source=sources[0])
    if not scratches:
        return {"call": "spectrum_of", "request": request}
    return {"call": "filter_to_scratch", "request": request, "scratch": scratches[0]}


def _joined(request: Request, sources: list[Path], scratches: list[Path]) -> dict[str, Any]:
    files = {"sources": sources, "scratches": scratches}
    return {"call": "joined_to_scratches", **files, "options": request.options}


def _run(
    processes: Processes,
    jobs: Sequence[Job],
    work: Callable[[Request, list[Path], list[Path]], dict[str, Any]],
) -> list[FileResult]:
    begin = time.monotonic()
    common: dict[str, Any] = {"waited": 0.0}
    own: list[dict[str, Any]] = [{"outcome": "failed"} for _ in jobs]
    try:
        with contextlib.ExitStack() as stack:
            folder = processes.folder
            sources = [stack.enter_context(storage.reading(job.source, folder)) for job in jobs]
            # Hashed before MeshLab reads them: a file changed meanwhile does not count as done.
            for one, source in zip(own, sources, strict=True):
                one["input_sha256"] = storage.digest(source)
            scratches = [
                stack.enter_context(storage.writing(job.target, job.overwrite, folder))
                for job in jobs
                if job.target is not None
            ]
            call = work(jobs[0].request, sources, scratches)
            answer = processes.run(call, jobs[0].seconds, common)
            written = [digests(scratch) for scratch in scratches] or [{}]
        report = answer.report
        largest = report.pop("largest", [report.get("max_displacement")])
        for one, digest, moved in zip(own, written, largest, strict=True):
            one |= digest | {"outcome": _outcome(jobs[0], moved)}
        common |= {"report": report, "peak_memory": answer.peak_memory}
        own[0] |= with_warnings({}, _warnings(report))  # once, not for every file
    except ProcessesEndedError:
        raise
    except ProcessStartError as error:
        raise BatchError(f"{error}; then run the same command with --resume") from error
    except SpectralError as error:
        common["reason"] = str(error)
    except OSError as error:
        common["reason"] = file_trouble(error) if error.strerror else f"a file's trouble: {error}"
    except Exception as error:
        common["reason"] = f"unexpected error: {error!r}; please report it"
    common["seconds"] = round(time.monotonic() - begin - common.pop("waited"), 3)
    return [
        job.result(versions=versions(), **common, **one) for job, one in zip(jobs, own, strict=True)
    ]


def _outcome(job: Job, moved: float | None) -> Outcome:
    if job.target is None:
        return "measured"
    return "unchanged" if moved == 0 else "filtered"


def _warnings(report: dict[str, Any]) -> list[Warned]:
    """Collect the warnings of a file and its filter, or of all the plugin's filters in a script."""
    parts = [*(one.get("report", {}) for one in report.get("filters", [])), report]
    return [warning for part in parts for warning in warned(part)]


def digests(scratch: Path) -> dict[str, Any]:
    """Return the SHA-256 of an output and its side files."""
    return {
        "output_sha256": storage.digest(scratch) if scratch.is_file() else None,
        "side_files": {
            path.relative_to(scratch.parent).as_posix(): storage.digest(path)
            for path in side_files(scratch)
        },
    }
