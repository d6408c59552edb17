"""Filtering many files: `filter_files`, and its parts for the commands."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import fields
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshlab_spectral.batch import storage
from meshlab_spectral.batch.jobs import FileResult
from meshlab_spectral.batch.plan import Batch, plan_batch
from meshlab_spectral.batch.report import Report, Tally
from meshlab_spectral.batch.settings import BatchKeywords, DenoiseBatchKeywords, Settings
from meshlab_spectral.extras import check_extras
from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.option_types import AnyOptions
from meshlab_spectral.filters.options import DenoiseOptions, FilterOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


@takes_options(Settings, FilterOptions)
def filter_files(
    inputs: Sequence[str | Path] | str | Path,
    output: str | Path,
    *,
    options: FilterOptions | None = None,
    **named: Unpack[BatchKeywords],
) -> Generator[FileResult, None, None]:
    """Filter many mesh files in worker processes, and iterate over the results.

    Work starts when the first result is requested, and continues while a result is used. The
    workers end with the iteration, or when the iterator is closed.

    Parameters
    ----------
    inputs
        Files, folders, patterns such as ``"scans/*.ply"``, and URLs supported by fsspec.
    output
        Output folder, a path or a URL; created if needed.
    options
        Those of the filter in one object, instead of by name.
    **named

    Yields
    ------
    FileResult
        The result of each file as soon as it is done; those of an earlier run come first.

    Raises
    ------
    InputError, MeshFileError, FormatError, OptionError
        Before anything is done: when inputs are missing, outputs already exist (and their inputs
        can be read) or would share a name, or an option is invalid.
    BatchError
        When the report cannot be written, no worker starts, or the Dask cluster cannot be reached.
    MissingPackageError
        When a scheduler is given, but Dask (extra `cluster`) is not installed.

    Examples
    --------
    >>> for result in filter_files("scans", "smooth", feature_size="2%"):
    ...     print(result.name, result.outcome, result.reason or "")
    """
    return _planned(FilterOptions, inputs, output, options, named)


@takes_options(Settings, DenoiseOptions)
def denoise_files(
    inputs: Sequence[str | Path] | str | Path,
    output: str | Path,
    *,
    options: DenoiseOptions | None = None,
    **named: Unpack[DenoiseBatchKeywords],
) -> Generator[FileResult, None, None]:
    """Denoise many mesh files in worker processes, as `filter_files` filters them.

    Parameters
    ----------
    inputs, output
        As for `filter_files`, which also says what is raised.
    options
        Those of the filter in one object, instead of by name.
    **named

    Yields
    ------
    FileResult
        The result of each file as soon as it is done; those of an earlier run come first.

    Examples
    --------
    >>> for result in denoise_files("scans", "clean"):
    ...     print(result.name, result.outcome, result.reason or "")
    """
    return _planned(DenoiseOptions, inputs, output, options, named)


def _planned(
    table: type[AnyOptions],
    inputs: Sequence[str | Path] | str | Path,
    output: str | Path,
    options: AnyOptions | None,
    named: Mapping[str, Any],
) -> Generator[FileResult, None, None]:
    of_filter = dict(named)
    own = {one.name: of_filter.pop(one.name) for one in fields(Settings) if one.name in of_filter}
    settings = Settings(**own)
    is_script = settings.script and options is None and not of_filter
    chosen = None if is_script else table.from_call(options, of_filter)
    locations = [inputs] if isinstance(inputs, str | Path) else inputs
    return run_batch(plan_batch(locations, output, settings, chosen), Tally())


def run_batch(batch: Batch, tally: Tally) -> Generator[FileResult, None, None]:
    """Run a planned batch, and count its results; see `filter_files`."""
    if batch.jobs and batch.settings.scheduler is not None:
        check_extras("cluster")
    with Report(batch.report) as report:
        begin = time.monotonic()
        now = datetime.now(timezone.utc).isoformat(timespec="seconds")
        report.add("run", {"begun": time.time(), "at": now, "files": len(batch.jobs)})
        for result in batch.done:
            tally.add(result)
            yield result
        for folder in batch.folders:
            storage.tidy(folder)
        if batch.jobs:
            try:
                with closing(_results(batch, report.add_result)) as results:
                    for result in results:
                        tally.add(result)
                        yield result
            finally:
                for folder in batch.folders:  # left by killed workers of a cluster
                    storage.tidy(folder)
        seconds = round(time.monotonic() - begin, 3)
        report.add("summary", {**tally.counts, **tally.warnings_by_kind(), "seconds": seconds})


def _results(
    batch: Batch, record: Callable[[FileResult], None]
) -> Generator[FileResult, None, None]:
    # Slow imports, not needed by commands for a single file.
    from meshlab_spectral.batch.task import run_job, run_together
    from meshlab_spectral.workers.opening import open_workers

    settings = batch.settings
    if not settings.joined:
        with (
            open_workers(
                run_job, settings.scheduler, settings.workers, settings.memory_limit
            ) as workers,
            closing(workers.run(batch.jobs, record)) as results,
        ):
            yield from results
        return
    with (
        open_workers(run_together, count=1, memory_limit=settings.memory_limit) as one,
        closing(one.run([batch.jobs], lambda done: [*map(record, done)])) as all_results,
    ):
        for together in all_results:
            yield from together
