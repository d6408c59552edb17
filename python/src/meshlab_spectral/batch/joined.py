"""Files that are one surface, cut into parts: filtered together, in one worker."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence
from typing import Any

from meshlab_spectral.batch import storage
from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.batch.task import digests
from meshlab_spectral.errors import SpectralError
from meshlab_spectral.files.whole_files import file_trouble
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.warned import warned, with_warnings
from meshlab_spectral.workers.processes import Processes


def run_joined(processes: Processes, jobs: Sequence[Job]) -> list[FileResult]:
    """Process files together; if one fails, all do."""
    begin = time.monotonic()
    common: dict[str, Any] = {"waited": 0.0}
    own: list[dict[str, Any]] = [{} for _ in jobs]
    try:
        with contextlib.ExitStack() as stack:
            folder = processes.folder
            sources = [stack.enter_context(storage.reading(job.source, folder)) for job in jobs]
            scratches = [
                stack.enter_context(storage.writing(job.target or "", job.overwrite, folder))
                for job in jobs
            ]
            for one, source in zip(own, sources, strict=True):
                one["input_sha256"] = storage.digest(source)
            work = {
                **jobs[0].work,
                "sources": [str(path) for path in sources],
                "scratches": [str(path) for path in scratches],
                "verbose": False,
            }
            answer = processes.run(work, jobs[0].seconds, common)
            report = answer.report
            for one, scratch, largest in zip(own, scratches, report.pop("largest"), strict=True):
                one |= digests(scratch) | {"outcome": "filtered" if largest else "unchanged"}
        common |= {"report": report, "peak_memory": answer.peak_memory}
        own[0] |= with_warnings({}, warned(report))  # once, not for every file
    except SpectralError as error:
        common["reason"] = str(error)
    except OSError as error:
        common["reason"] = file_trouble(error)
    if "reason" in common:
        for one in own:
            one["outcome"] = "failed"
    common["seconds"] = round(time.monotonic() - begin - common.pop("waited"), 3)
    return [
        job.result(versions=versions(), **common, **one) for job, one in zip(jobs, own, strict=True)
    ]
