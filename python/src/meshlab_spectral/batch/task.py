"""Processing of one file in a worker; every error becomes a result."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from meshlab_spectral.batch import storage
from meshlab_spectral.batch.jobs import FileResult, Job, Outcome
from meshlab_spectral.errors import (
    BatchError,
    ProcessStartError,
    SpectralError,
)
from meshlab_spectral.files.whole_files import file_trouble, side_files
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.warned import Warned, warned, with_warnings
from meshlab_spectral.workers.processes import Processes, ProcessesEndedError


def run_job(processes: Processes, job: Job) -> FileResult:
    """Process one file; the outcome is "filtered", "unchanged", "measured" or "failed".

    Errors with a single file are not raised. Raises BatchError when no process starts, and
    ProcessesEndedError when the processes are ended meanwhile.
    """
    begin = time.monotonic()
    result: dict[str, Any] = {"outcome": "failed", "waited": 0.0}
    try:
        with storage.reading(job.source, processes.folder) as source:
            # Hashed before MeshLab reads it: a file changed meanwhile does not count as done.
            result["input_sha256"] = storage.digest(source)
            work = job.work | {"source": str(source), "verbose": False}
            if job.target is None:
                answer = processes.run(work, job.seconds, result)
            else:
                with storage.writing(job.target, job.overwrite, processes.folder) as scratch:
                    work["scratch"] = str(scratch)
                    answer = processes.run(work, job.seconds, result)
                    written = digests(scratch)
                result |= written
        result["outcome"] = _outcome(job, answer.report)
        result |= {"report": answer.report, "peak_memory": answer.peak_memory}
        result |= with_warnings({}, _warnings(answer.report))
    except ProcessesEndedError:
        raise
    except ProcessStartError as error:
        raise BatchError(f"{error}; then run the same command with --resume") from error
    except SpectralError as error:
        result["reason"] = str(error)
    except OSError as error:
        result["reason"] = file_trouble(error) if error.strerror else f"a file's trouble: {error}"
    except Exception as error:
        result["reason"] = f"unexpected error: {error!r}; please report it"
    return job.result(
        seconds=round(time.monotonic() - begin - result.pop("waited"), 3),
        versions=versions(),
        **result,
    )


def _outcome(job: Job, report: dict[str, Any]) -> Outcome:
    if job.target is None:
        return "measured"
    return "unchanged" if report.get("max_displacement") == 0 else "filtered"


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
