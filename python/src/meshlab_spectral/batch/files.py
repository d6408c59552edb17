"""Filtering many files: `filter_files`, and its parts for the commands."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from datetime import datetime, timezone
from functools import partial
from pathlib import Path
from typing import Any, get_args

from meshlab_spectral.batch import storage
from meshlab_spectral.batch.jobs import FileResult, Job, Outcome
from meshlab_spectral.batch.outputs import DEFAULT_PATTERN
from meshlab_spectral.batch.plan import Batch, plan_batch
from meshlab_spectral.batch.report import Report, grouped_warnings
from meshlab_spectral.errors import OptionError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.filters.options import FilterOptions


@dataclass(frozen=True)
class Workers:
    """The workers of a batch: new ones on this machine, or those of a Dask scheduler.

    The attributes are parameters of `filter_files`.

    Raises
    ------
    OptionError
        When both kinds are asked for.
    """

    count: int | None = None
    memory_limit: int | None = None
    scheduler: str | None = None

    def __post_init__(self) -> None:
        if self.scheduler is not None and (self.count, self.memory_limit) != (None, None):
            raise OptionError(
                "a cluster configures its own workers: with a scheduler, leave out the number of "
                "workers and the memory limit"
            )

    @contextmanager
    def started(self) -> Iterator[Callable[[Sequence[Job]], Iterator[FileResult]]]:
        """Yield a function that runs jobs, see `engine.run_jobs`."""
        # A slow import, not needed by commands for a single file.
        from meshlab_spectral.batch import engine

        cluster: AbstractContextManager[Any] = (
            engine.workers_at(self.scheduler)
            if self.scheduler
            else engine.local_workers(self.count, self.memory_limit)
        )
        with cluster as client:
            yield partial(engine.run_jobs, client)


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
    """Filter many mesh files in worker processes, and iterate over the results.

    Work starts when the first result is requested. The workers import the main module of the
    program, so a script needs a guard, see the example. They are ended with the iteration, or by
    the iterator's `close`.

    Parameters
    ----------
    inputs
        Files, folders, patterns such as ``"scans/*.ply"``, URLs supported by fsspec.
    output
        Output folder, a path or a URL; created if needed.
    script
        A MeshLab filter script (.mlx) to apply instead of `options`.
    recursive
        Search subfolders, too, and keep their structure.
    name
        Pattern for output names, with {stem}, {ending} and {folder} of the input.
    ending
        Output format, such as "ply"; by default that of each input.
    overwrite
        Replace existing outputs, even ones created meanwhile. Inputs are never replaced.
    resume
        Continue an earlier run, if there was one: skip what its report proves done with the same
        options, inputs and versions; replace outputs changed since.
    report
        File for one JSON line per file, by default batch_report.jsonl in `output`.
    timeout
        Time limit per file in seconds; by default none.
    workers
        Number of files processed at once; by default one per processor.
    memory_limit
        Bytes per worker; by default they share nine tenths of the machine's memory.
    scheduler
        Address of a Dask scheduler whose workers to use; excludes `workers` and `memory_limit`.
    **options
        Fields of `FilterOptions`; sizes as a string such as "2%", or as a length.

    Yields
    ------
    FileResult
        The result of each file, as soon as it is done; those of an earlier run first.

    Raises
    ------
    InputError, FormatError, OptionError
        Before anything is done: when inputs are missing, outputs already exist or would share a
        name, or an option is invalid.
    BatchError
        When the report cannot be written, or the Dask cluster cannot be reached.
    MissingPackageError
        When Dask, of the extra `batch`, is not installed.

    Examples
    --------
    >>> if __name__ == "__main__":
    ...     for result in filter_files("scans", "smooth", feature_size="2%"):
    ...         print(result.name, result.outcome, result.reason or "")
    """
    using = Workers(workers, memory_limit, scheduler)
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
    return run_batch(batch, using)


def run_batch(batch: Batch, workers: Workers) -> Generator[FileResult, None, None]:
    """Run a planned batch; see `filter_files`."""
    if batch.jobs:
        check_extras("batch")
    with Report(batch.report) as report:
        counts = dict.fromkeys(get_args(Outcome), 0) | {"already done": len(batch.done)}
        warnings = {one.name: one.warnings for one in batch.done if one.warnings}
        begin = time.monotonic()
        report.add("run", {"begun": time.time(), "at": _now(), "files": len(batch.jobs)})
        yield from batch.done
        for folder in batch.folders:
            storage.tidy(folder)
        if batch.jobs:
            try:
                with workers.started() as run:
                    for result in run(batch.jobs):
                        report.add("file", result.as_record())
                        counts[result.outcome] += 1
                        if result.warnings:
                            warnings[result.name] = result.warnings
                        yield result
            finally:
                for folder in batch.folders:  # of workers that were ended
                    storage.tidy(folder)
        seconds = round(time.monotonic() - begin, 3)
        told = {"with_warnings": len(warnings), "warnings": grouped_warnings(warnings)}
        report.add("summary", {**counts, **told, "seconds": seconds})


def _now() -> str:
    return datetime.now(timezone.utc).isoformat(timespec="seconds")
