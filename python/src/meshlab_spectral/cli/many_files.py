"""Shared by the commands for many files: their options, and runs with a progress display."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from contextlib import AbstractContextManager, closing, nullcontext
from typing import Annotated

import typer

from meshlab_spectral.batch.files import run_batch
from meshlab_spectral.batch.jobs import FileResult
from meshlab_spectral.batch.plan import Batch
from meshlab_spectral.cli.messages import MESSAGES
from meshlab_spectral.cli.progress import batch_progress

INTERRUPTED = "finished files are in the report; continue with --resume"

_SIZE = re.compile(r"(?P<number>\d+(\.\d+)?)\s*(?P<unit>[KMGT]?)(i?B)?", re.IGNORECASE)
_UNITS = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}


def _bytes(text: str | int) -> int:
    if isinstance(text, int):
        return text
    match = _SIZE.fullmatch(text.strip())
    size = int(float(match["number"]) * _UNITS[match["unit"].upper()]) if match else 0
    if not size:
        raise typer.BadParameter(f"{text!r}: give a size such as 4GB or 500MB")
    return size


Inputs = Annotated[
    list[str],
    typer.Argument(
        metavar="INPUT",
        help="Mesh files, folders, quoted patterns such as 'scans/*.ply', URLs.",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, help="Files processed at once. By default one per processor."),
]
MemoryLimit = Annotated[
    int | None,
    typer.Option(
        "--memory-limit",
        parser=_bytes,
        metavar="SIZE",
        help="Memory limit per worker, such as 4GB. By default they share the machine's.",
    ),
]
Timeout = Annotated[
    float | None,
    typer.Option("--timeout", min=1, help="Time limit per file in seconds. By default none."),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Use the workers of a running Dask cluster, such as tcp://host:8786; they must see "
        "the files under the same paths.",
    ),
]
Debug = Annotated[bool, typer.Option("--debug", hidden=True)]


def planning_shown(resume: bool) -> AbstractContextManager[object]:
    """Show on a terminal that files are compared with the report, which may take a while."""
    if resume and MESSAGES.is_terminal:
        return MESSAGES.status("Comparing files with the report")
    return nullcontext()


def run_shown(
    batch: Batch,
    workers: int | None,
    memory_limit: int | None,
    scheduler: str | None,
    take: Callable[[FileResult], None] = lambda result: None,
) -> Counter[str]:
    """Run a batch with a progress display, and pass each result to `take`.

    Returns
    -------
    Counter
        Number of results by outcome, and "with warnings".
    """
    counts: Counter[str] = Counter()
    running = run_batch(batch, workers=workers, memory_limit=memory_limit, scheduler=scheduler)
    with (
        batch_progress(MESSAGES, len(batch.jobs) + len(batch.done)) as on_result,
        closing(running) as results,  # ends the workers on an interrupt
    ):
        for result in results:
            counts[result.outcome] += 1
            counts["with warnings"] += bool(result.warnings)
            on_result(result)
            take(result)
    return counts


def summary_of(counts: Counter[str], done: str) -> str:
    """Format the counts of `run_shown`; `done` is the outcome of a successful file."""
    always = f"{counts[done]} {done}, {counts['failed']} failed"
    same = f", {counts['unchanged']} unchanged" if counts["unchanged"] else ""
    before = f", {counts['already done']} already done" if counts["already done"] else ""
    warned = f", {counts['with warnings']} with warnings" if counts["with warnings"] else ""
    return always + same + before + warned
