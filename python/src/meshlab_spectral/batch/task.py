"""Processing of one file in a worker; every error becomes a result."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from meshlab_spectral.batch import storage
from meshlab_spectral.batch.jobs import FileResult, Job, Outcome
from meshlab_spectral.batch.processes import processes
from meshlab_spectral.errors import MemoryLimitError, ProcessDiedError, SpectralError
from meshlab_spectral.files.whole_files import side_files
from meshlab_spectral.plugin.limits import given_memory_limit, threads_each
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.process.parent import Answer, JobLimits

# If its process dies, a mesh gets a second try in a new one: an earlier mesh may be to blame.
ATTEMPTS = 2


def run_job(job: Job, memory_limit: int | None = None) -> FileResult:
    """Process one file; the outcome is "filtered", "unchanged", "measured" or "failed".

    Errors with a single file are not raised. `memory_limit` is in bytes, for MeshLab's process; by
    default its share of the Dask worker's limit, or that of the environment if that is lower.
    """
    begin = time.monotonic()
    result: dict[str, Any] = {"outcome": "failed", "waited": 0.0}
    try:
        limits = JobLimits(memory_limit or _default_memory_limit(), job.seconds)
        _share_threads()
        with storage.reading(job.source) as source:
            # Hashed before MeshLab reads it: a file changed meanwhile does not count as done.
            result["input_sha256"] = storage.digest(source)
            work = job.work | {"source": str(source), "verbose": False}
            if job.target is None:
                answer = _attempt(work, limits, result)
            else:
                with storage.writing(job.target, job.overwrite) as scratch:
                    answer = _attempt(work | {"scratch": str(scratch)}, limits, result)
                    written = _digests(scratch)
                result |= written
        result["outcome"] = _outcome(job, answer.report)
        result |= {"report": answer.report, "peak_memory": answer.peak_memory}
        result["warnings"] = _warnings(answer.report)
    except SpectralError as error:
        result["reason"] = str(error)
    except OSError as error:
        result["reason"] = f"a file cannot be read or written ({error})"
    return job.result(
        seconds=round(time.monotonic() - begin - result.pop("waited"), 3),
        versions=versions(),
        **result,
    )


def _outcome(job: Job, report: dict[str, Any]) -> Outcome:
    if job.target is None:
        return "measured"
    return "unchanged" if report.get("max_displacement") == 0 else "filtered"


def _warnings(report: dict[str, Any]) -> list[str]:
    """Collect the warnings of a file and its filter, or of all the plugin's filters in a script."""
    parts = [*(one.get("report", {}) for one in report.get("filters", [])), report]
    return [warning for part in parts for warning in part.get("warnings", [])]


def _digests(scratch: Path) -> dict[str, Any]:
    """Return the SHA-256 of an output and its side files."""
    return {
        "output_sha256": storage.digest(scratch) if scratch.is_file() else None,
        "side_files": {
            path.relative_to(scratch.parent).as_posix(): storage.digest(path)
            for path in side_files(scratch)
        },
    }


def _attempt(work: dict[str, Any], limits: JobLimits, result: dict[str, Any]) -> Answer:
    for attempt in range(1, ATTEMPTS + 1):
        result["attempts"] = attempt
        begin = time.monotonic()
        with processes.one(limits) as process:
            result["waited"] += time.monotonic() - begin
            try:
                return process.run(work, limits=limits)
            except (ProcessDiedError, MemoryLimitError):
                if attempt == ATTEMPTS:
                    raise
    raise AssertionError("unreachable")


def _default_memory_limit() -> int | None:
    limits = [limit for limit in (_worker_memory(), given_memory_limit()) if limit is not None]
    return min(limits, default=None)


def _worker_memory() -> int | None:
    """Return the memory per concurrent job of this Dask worker in bytes, if limited."""
    worker = _worker()
    limit = worker.memory_manager.memory_limit if worker else None
    return int(limit / _at_once(worker)) if limit else None


def _share_threads() -> None:
    """Set each process's share of the threads, unless the number is already set."""
    if processes.threads is None:
        processes.threads = threads_each(_at_once(_worker()))


def _at_once(worker: Any) -> int:
    """Return the maximum number of concurrent jobs in this worker."""
    return processes.at_once or (worker.state.nthreads if worker else 1)


def _worker() -> Any:
    from distributed import get_worker

    try:
        return get_worker()
    except ValueError:
        return None
