"""Shared by the commands for many files: their options, and runs with progress and warnings."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import typer

from meshlab_spectral.batch.files import Workers, run_batch
from meshlab_spectral.batch.jobs import FileResult
from meshlab_spectral.batch.plan import Batch
from meshlab_spectral.batch.report import grouped_warnings
from meshlab_spectral.cli.messages import MESSAGES, VERBOSITY, print_warning
from meshlab_spectral.cli.progress import batch_progress

INTERRUPTED = "finished files are in the report; continue with --resume"

_SIZE = re.compile(r"(?P<number>\d+(\.\d+)?)\s*(?P<unit>[KMGT]?)(i?B)?", re.IGNORECASE)
_WARNINGS_AT_MOST, _NAMED_AT_MOST = 10, 4
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
        metavar="INPUT", help="Mesh files, folders, quoted patterns such as 'scans/*.ply', URLs."
    ),
]
WorkerCount = Annotated[
    int | None, typer.Option(min=1, help="Files processed at once. By default one per processor.")
]
MemoryLimit = Annotated[
    int | None,
    typer.Option(
        parser=_bytes,
        metavar="SIZE",
        help="Memory limit per worker, such as 4GB. By default they share the machine's.",
    ),
]
Timeout = Annotated[
    float | None, typer.Option(min=1, help="Time limit per file in seconds. By default none.")
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Use the workers of a running Dask cluster, such as tcp://host:8786; they must see "
        "the files under the same paths.",
    ),
]
Recursive = Annotated[
    bool, typer.Option("--recursive", "-r", help="Search subfolders of INPUT, too.")
]
ReportFile = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="The report, one JSON object per line; appended to if it exists. By default next to "
        "the outputs.",
    ),
]
Resume = Annotated[
    bool,
    typer.Option(
        "--resume",
        help="Skip what the report proves done with the same input, options and versions; replace "
        "outputs changed since.",
    ),
]


@dataclass
class Tally:
    """What has become of the files of a batch.

    Attributes
    ----------
    counts
        Number of results by outcome.
    warnings
        The warnings of each file that has any, by its name.
    """

    counts: Counter[str] = field(default_factory=Counter)
    warnings: dict[str, list[str]] = field(default_factory=dict)

    def summary(self, done: str) -> str:
        """Format the counts; `done` is the outcome of a successful file."""
        text = f"{self.counts[done]} {done}, {self.counts['failed']} failed"
        for outcome in ("unchanged", "already done"):
            if self.counts[outcome]:
                text += f", {self.counts[outcome]} {outcome}"
        return text + (f", {len(self.warnings)} with warnings" if self.warnings else "")


def planning_shown(resume: bool) -> AbstractContextManager[object]:
    """Show on a terminal that files are compared with the report, which may take a while."""
    if resume and MESSAGES.is_terminal and not VERBOSITY.quiet:
        return MESSAGES.status("Comparing files with the report")
    return nullcontext()


def run_shown(
    batch: Batch,
    workers: Workers,
    take: Callable[[FileResult], None] = lambda result: None,
) -> Tally:
    """Run a batch, pass each result to `take`, and print progress and finally the warnings."""
    tally = Tally()
    with (
        batch_progress(len(batch.jobs) + len(batch.done)) as on_result,
        closing(run_batch(batch, workers)) as results,  # ends the workers on an interrupt
    ):
        for result in results:
            tally.counts[result.outcome] += 1
            if result.warnings:
                tally.warnings[result.name] = result.warnings
            on_result(result)
            take(result)
    _print_warnings(grouped_warnings(tally.warnings), batch.report)
    return tally


def _print_warnings(groups: list[dict[str, Any]], report: Path) -> None:
    """Print warnings with the names of their files; many only with --verbose."""
    most, named = (len(groups), None) if VERBOSITY.verbose else (_WARNINGS_AT_MOST, _NAMED_AT_MOST)
    for group in groups[:most]:
        first, *others = group["files"]
        shown = ", ".join(others[:named])
        dots = ", ..." if named is not None and len(others) > named else ""
        more = f" and {len(others)} more ({shown}{dots})" if others else ""
        print_warning(f"{first}{more}: {group['warning']}")
    if len(groups) > most:
        print_warning(
            f"{len(groups) - most} more, see them with --verbose or at the end of {report}"
        )
