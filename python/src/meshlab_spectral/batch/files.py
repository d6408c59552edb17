"""Filtering many files: `filter_files`, and the parts of it that the commands use."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from datetime import datetime, timezone
from functools import partial
from pathlib import Path
from typing import Any, get_args

from meshlab_spectral.batch import storage
from meshlab_spectral.batch.jobs import FileResult, Job, Outcome
from meshlab_spectral.batch.outputs import DEFAULT_PATTERN
from meshlab_spectral.batch.plan import Batch, plan_batch
from meshlab_spectral.batch.report import Report
from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.options import FilterOptions


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
) -> Generator[FileResult, None, None]:
    """Filter many mesh files in worker processes; iterate over the results.

    Nothing is done until the first result is asked for. Worker processes are started anew from the
    main module of the program, so that a script has to be guarded, see the example. The workers
    are ended when the iteration is, or by `close` of the iterator.

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
        Replace files that are, or meanwhile appear, at the places of outputs. An input is never
        replaced.
    resume
        Take up an earlier run, if there was one: leave out what its report proves done with the
        same options, the same inputs and the same versions; replace outputs that have been changed
        since.
    report
        File that gets one JSON line a file, by default batch_report.jsonl in `output`.
    timeout
        Seconds that a file may take; by default any.
    workers
        How many files are done at once; by default as many as there are processors.
    memory_limit
        Bytes for each worker; by default they share nine tenths of the machine's.
    scheduler
        Address of a Dask scheduler whose workers do the work; to be given without the last two.
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
    check_workers(scheduler, workers, memory_limit)
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


def check_workers(scheduler: str | None, workers: int | None, memory_limit: int | None) -> None:
    """Raise OptionError when a cluster is asked for other workers than it has."""
    if scheduler is not None and (workers is not None or memory_limit is not None):
        raise OptionError(
            "the workers of a cluster are its own: with a scheduler, leave out the number of "
            "workers and the memory limit"
        )


def run_batch(
    batch: Batch,
    *,
    workers: int | None = None,
    memory_limit: int | None = None,
    scheduler: str | None = None,
) -> Generator[FileResult, None, None]:
    """Do what has been planned; see `filter_files`."""
    with Report(batch.report) as report:
        counts = dict.fromkeys(get_args(Outcome), 0) | {"unchanged": len(batch.done)}
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
    counts: dict[Outcome, int],
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
