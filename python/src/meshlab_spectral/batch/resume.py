"""Recognizing finished jobs in the report of an earlier run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.batch.storage import digest_at, sibling
from meshlab_spectral.warned import warned, with_warnings

Records = dict[str, list[dict[str, Any]]]

_DONE = ("filtered", "unchanged", "measured")
# Versions a result depends on.
_DECIDING_VERSIONS = ("meshlab_spectral", "core", "pymeshlab")


def done_records(report: Iterable[Mapping[str, Any]]) -> Records:
    """Collect the report lines of finished files, by output name."""
    records: Records = {}
    for record in report:
        if record.get("kind") == "file" and record.get("outcome") in _DONE:
            records.setdefault(str(record.get("name")), []).append(dict(record))
    return records


def proved_done(
    jobs: Iterable[Job], records: Records, versions: Mapping[str, str]
) -> dict[Job, FileResult]:
    """Find the jobs that are already done, with their recorded results as "already done".

    A job is done if one of the `records`, from `done_records`, has its options, the current
    `versions`, and the current SHA-256 of its input, its output and the output's side files.
    """
    candidates = [job for job in jobs if job.name in records]
    with ThreadPoolExecutor() as pool:  # most of the time is spent reading
        found = pool.map(lambda job: _proof(job, records[job.name], versions), candidates)
        return {job: result for job, result in zip(candidates, found, strict=True) if result}


def _proof(
    job: Job, records: list[dict[str, Any]], versions: Mapping[str, str]
) -> FileResult | None:
    fitting = [
        record
        for record in records
        if record.get("options") == job.options and _same_versions(record, versions)
    ]
    if not fitting:
        return None
    source = digest_at(job.source)
    output = digest_at(job.target) if job.target is not None else None
    if source is None or (output is None and job.target is not None):
        return None
    for record in reversed(fitting):
        if (
            record.get("input_sha256") == source
            and record.get("output_sha256") == output
            and _same_side_files(job, record.get("side_files", {}))
        ):
            return job.result(
                "already done",
                report=record.get("report"),
                **with_warnings({}, warned(record)),
                input_sha256=source,
                output_sha256=output,
                side_files=record.get("side_files", {}),
                versions=record["versions"],
            )
    return None


def _same_side_files(job: Job, recorded: Mapping[str, str]) -> bool:
    return all(
        job.target is not None and digest_at(sibling(job.target, name)) == sha256
        for name, sha256 in recorded.items()
    )


def _same_versions(record: Mapping[str, Any], versions: Mapping[str, str]) -> bool:
    recorded = record.get("versions")
    return isinstance(recorded, dict) and all(
        recorded.get(name) == versions[name] for name in _DECIDING_VERSIONS
    )
