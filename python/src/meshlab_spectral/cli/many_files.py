"""What the commands for many files share: their options, and a run with its progress shown."""

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

INTERRUPTED = "what is done is in the report; go on with --resume"

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
        help="Mesh files, folders, patterns in quotes such as 'scans/*.ply', URLs.",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, help="Files at once. By default one for each processor."),
]
MemoryLimit = Annotated[
    int | None,
    typer.Option(
        "--memory-limit",
        parser=_bytes,
        metavar="SIZE",
        help="Memory that a worker may use, such as 4GB. By default they share the machine's.",
    ),
]
Timeout = Annotated[
    float | None,
    typer.Option("--timeout", min=1, help="Seconds that a file may take. By default any."),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Use the workers of a Dask cluster that is running, such as tcp://host:8786; they "
        "must see the files under the same names.",
    ),
]
Debug = Annotated[bool, typer.Option("--debug", hidden=True)]


def planning_shown(resume: bool) -> AbstractContextManager[object]:
    """Say on a terminal that files are compared with the report; large ones take a while."""
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
    """Run a batch with its progress shown, and hand every result to `take`.

    Returns
    -------
    Counter
        How many results there were of every outcome, and "with warnings".
    """
    counts: Counter[str] = Counter()
    running = run_batch(batch, workers=workers, memory_limit=memory_limit, scheduler=scheduler)
    with (
        batch_progress(MESSAGES, len(batch.jobs) + len(batch.done)) as on_result,
        closing(running) as results,  # ends the workers when it is interrupted
    ):
        for result in results:
            counts[result.outcome] += 1
            counts["with warnings"] += bool(result.warnings)
            on_result(result)
            take(result)
    return counts


def told(counts: Counter[str], done: str) -> str:
    """Put the counts of `run_shown` into words; `done` is the outcome of a file that went well."""
    always = f"{counts[done]} {done}, {counts['failed']} failed"
    before = f", {counts['unchanged']} done before" if counts["unchanged"] else ""
    warned = f", {counts['with warnings']} with warnings" if counts["with warnings"] else ""
    return always + before + warned
