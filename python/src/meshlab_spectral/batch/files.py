"""Filtering many files: `filter_files`, and the parts of it that the command `batch` uses."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from datetime import datetime, timezone
from functools import partial
from pathlib import Path
from typing import Any

from meshlab_spectral.batch import storage
from meshlab_spectral.batch.inputs import Input, find_inputs
from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.batch.outputs import DEFAULT_PATTERN, Output, plan_outputs
from meshlab_spectral.batch.report import DEFAULT_NAME, Report, read_report
from meshlab_spectral.batch.resume import Records, done_records, proved_done
from meshlab_spectral.errors import InputError, OptionError
from meshlab_spectral.filter_script import script_filters
from meshlab_spectral.options import FilterOptions
from meshlab_spectral.versions import versions

# Clocks of a file server and of this machine may differ by so many seconds.
_CLOCK_SLACK = 2.0
_NAMED_AT_MOST = 5


@dataclass(frozen=True)
class Batch:
    """What is to be done, found out and checked before anything is done.

    Attributes
    ----------
    jobs
        Left to be done, in the order of the inputs.
    done
        Results of an earlier run that stand.
    report
        File of the report.
    """

    jobs: list[Job]
    done: list[FileResult] = field(default_factory=list)
    report: Path = Path(DEFAULT_NAME)

    @property
    def folders(self) -> list[str]:
        """Folders that outputs go to."""
        targets = [job.target for job in self.jobs if job.target is not None]
        return sorted({target.rpartition("/")[0] for target in targets})


def plan_batch(
    inputs: Sequence[str | Path],
    output: str | Path,
    options: FilterOptions | None = None,
    *,
    script: str | Path | None = None,
    recursive: bool = False,
    name: str = DEFAULT_PATTERN,
    ending: str | None = None,
    overwrite: bool = False,
    resume: bool = False,
    report: str | Path | None = None,
    timeout: float | None = None,
) -> Batch:
    """Find the inputs of a batch, name its outputs, and check that nothing would be lost.

    The parameters and errors are those of `filter_files`.
    """
    work, described = _work(options, script)
    folder = storage.located(str(output))
    report_path = _report_path(folder, report)
    records: Records = {}
    begun = None
    if resume or report_path.is_file():
        lines = list(read_report(report_path))
        records = done_records(lines)
        begun = min((line["begun"] for line in lines if line.get("kind") == "run"), default=None)
    planned = plan_outputs(
        _inputs(inputs, folder, recursive, report_path, records), folder, name, ending
    )
    jobs = [_job(output, work, described, timeout) for output in planned]
    done = proved_done(jobs, records, versions()) if resume else {}
    left = [job for job in jobs if job not in done]
    proved = {job.name for job in done}
    if not overwrite:
        targets = [output.target for output in planned if output.name not in proved]
        _refuse_to_replace(targets, begun if resume else None)
    return Batch(left, list(done.values()), report_path)


def filter_files(
    inputs: Sequence[str | Path] | str | Path,
    output: str | Path,
    *,
    script: str | Path | None = None,
    recursive: bool = False,
    name: str = DEFAULT_PATTERN,
    ending: str | None = None,
    overwrite: bool = False,
    resume: bool = False,
    report: str | Path | None = None,
    timeout: float | None = None,
    workers: int | None = None,
    memory_limit: int | None = None,
    scheduler: str | None = None,
    **options: Any,
) -> Iterator[FileResult]:
    """Filter many mesh files in worker processes; iterate over the results.

    Nothing is done until the first result is asked for. Worker processes are started anew from the
    main module of the program, so that a script has to be guarded, see the example.

    Parameters
    ----------
    inputs
        Files, folders, patterns such as "scans/*.ply", URLs that fsspec knows.
    output
        Folder of the outputs, made as needed; a path or a URL.
    script
        A filter script of MeshLab (.mlx) to apply, in place of `options`.
    recursive
        Search the folders in folders, too; their structure is kept.
    name
        Pattern of the names of the outputs: {stem}, {ending} and {folder} of the input.
    ending
        Format of the outputs, such as "ply"; by default that of each input.
    overwrite
        Replace outputs that exist. An input is never replaced.
    resume
        Take up an earlier run, if there was one: leave out what its report proves done with the
        same options, the same inputs and the same versions.
    report
        File that gets one JSON line a file, by default batch_report.jsonl in `output`.
    timeout
        Seconds that a file may take; by default any.
    workers
        How many files are done at once; by default as many as there are processors.
    memory_limit
        Bytes for each worker; by default they share nine tenths of the machine's.
    scheduler
        Address of a Dask scheduler whose workers do the work, in place of the last two.
    **options
        Fields of `FilterOptions`; sizes as text such as "2%", or as a length.

    Yields
    ------
    FileResult
        Of every file, as soon as it is done; those of an earlier run first.

    Raises
    ------
    InputError, FormatError, OptionError
        Before anything is done: when inputs are missing, outputs exist already or would have the
        same name, or an option is wrong.
    BatchError
        When the report cannot be written, or the Dask cluster is out of reach.

    Examples
    --------
    >>> if __name__ == "__main__":
    ...     for result in filter_files("scans", "smooth", feature_size="2%"):
    ...         print(result.name, result.outcome, result.reason or "")
    """
    chosen = None if script is not None and not options else FilterOptions.from_dict(options)
    batch = plan_batch(
        [inputs] if isinstance(inputs, str | Path) else inputs,
        output,
        chosen,
        script=script,
        recursive=recursive,
        name=name,
        ending=ending,
        overwrite=overwrite,
        resume=resume,
        report=report,
        timeout=timeout,
    )
    return run_batch(batch, workers=workers, memory_limit=memory_limit, scheduler=scheduler)


def run_batch(
    batch: Batch,
    *,
    workers: int | None = None,
    memory_limit: int | None = None,
    scheduler: str | None = None,
) -> Iterator[FileResult]:
    """Do what `plan_batch` has planned; see `filter_files`."""
    with Report(batch.report) as report:
        counts = {"filtered": 0, "failed": 0, "unchanged": len(batch.done)}
        begin = time.monotonic()
        report.add("run", {"begun": time.time(), "at": _now(), "files": len(batch.jobs)})
        yield from batch.done
        for folder in batch.folders:
            storage.tidy(folder)
        if batch.jobs:
            try:
                yield from _run(batch.jobs, report, counts, workers, memory_limit, scheduler)
            finally:
                for folder in batch.folders:  # of workers that were ended
                    storage.tidy(folder)
        report.add("summary", {**counts, "seconds": round(time.monotonic() - begin, 3)})


def _run(
    jobs: list[Job],
    report: Report,
    counts: dict[str, int],
    workers: int | None,
    memory_limit: int | None,
    scheduler: str | None,
) -> Iterator[FileResult]:
    with workers_for(scheduler, workers, memory_limit) as run:
        for result in run(jobs):
            report.add("file", result.as_record())
            counts[result.outcome] += 1
            yield result


@contextmanager
def workers_for(
    scheduler: str | None, workers: int | None = None, memory_limit: int | None = None
) -> Iterator[Callable[[Sequence[Job]], Iterator[FileResult]]]:
    """Give what has jobs done: by the workers of a scheduler, else by ones that are started here.

    See `engine.run_jobs`, `engine.workers_at` and `engine.local_workers`.
    """
    # Here, as it takes a while: a command that only filters one file needs none of it.
    from meshlab_spectral.batch import engine

    cluster: AbstractContextManager[Any] = (
        engine.workers_at(scheduler) if scheduler else engine.local_workers(workers, memory_limit)
    )
    with cluster as client:
        yield partial(engine.run_jobs, client)


def _now() -> str:
    return datetime.now(timezone.utc).isoformat(timespec="seconds")


def _work(
    options: FilterOptions | None, script: str | Path | None
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Give the work of every job, and what describes it in the report."""
    if script is None:
        described = (options or FilterOptions()).as_dict()
        return {"task": "filter", "options": described}, described
    if options is not None:
        raise OptionError(
            "a script has its parameters in itself: give either a script or options of the filter"
        )
    try:
        content = Path(script).read_bytes()
        text = content.decode()
    except OSError as error:
        raise InputError(f"the script {script} cannot be read ({error.strerror})") from error
    except UnicodeDecodeError:
        raise OptionError(f"{script} is no filter script of MeshLab") from None
    described = {
        "script": Path(script).name,
        "script_sha256": hashlib.sha256(content).hexdigest(),
        "filters": script_filters(text),
    }
    return {"task": "script", "script": text}, described


def _report_path(folder: str, report: str | Path | None) -> Path:
    if report is not None:
        return Path(report).absolute()
    if storage.is_url(folder):
        raise InputError("the outputs go to a URL, the report to a file here: name it (--report)")
    return Path(folder, DEFAULT_NAME)


def _inputs(
    inputs: Sequence[str | Path],
    folder: str,
    recursive: bool,
    report: Path,
    records: Records,
) -> list[Input]:
    """Find the inputs; outputs of an earlier run that lie among them are none."""
    leave_out = [report]
    given = {storage.located(str(place)) for place in inputs}
    if not storage.is_url(folder):
        leave_out += [Path(folder, name) for name in records]
        if folder not in given:
            leave_out.append(Path(folder))
    return find_inputs([str(place) for place in inputs], recursive, leave_out)


def _job(
    output: Output, work: dict[str, Any], described: dict[str, Any], timeout: float | None
) -> Job:
    return Job(output.source, output.target, output.name, work, described, timeout)


def _refuse_to_replace(targets: Sequence[str], begun: float | None) -> None:
    """Refuse to replace files; those that the run to be resumed has made may be."""
    taken = [
        target
        for target in storage.existing(list(targets))
        if begun is None or not _made_since(target, begun)
    ]
    if taken:
        more = ", ..." if len(taken) > _NAMED_AT_MOST else ""
        raise InputError(
            f"{len(taken)} of the outputs exist already "
            f"({', '.join(taken[:_NAMED_AT_MOST])}{more}): choose another folder, replace them "
            "with --overwrite, or take up an earlier run with --resume"
        )


def _made_since(target: str, begun: float) -> bool:
    if storage.is_url(target):
        return True  # which tells no time that can be relied on
    path = Path(target)
    return path.is_file() and path.stat().st_mtime >= begun - _CLOCK_SLACK
