"""Shared by the commands for many files: their options, and runs with progress and warnings."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, closing, nullcontext
from pathlib import Path
from typing import Annotated, Any

import typer

from meshlab_spectral.batch.files import run_batch
from meshlab_spectral.batch.jobs import FileResult
from meshlab_spectral.batch.plan import Batch
from meshlab_spectral.batch.report import Tally
from meshlab_spectral.cli.messages import MESSAGES, VERBOSITY, print_warning
from meshlab_spectral.cli.progress import batch_progress

INTERRUPTED = "finished files are in the report; continue with --resume"

_WARNINGS_AT_MOST, _NAMED_AT_MOST = 10, 4


Inputs = Annotated[
    list[str],
    typer.Argument(
        metavar="INPUT", help="Mesh files, folders, quoted patterns such as 'scans/*.ply', URLs."
    ),
]


def planning_shown(resume: bool) -> AbstractContextManager[object]:
    """Show on a terminal that files are compared with the report, which may take a while."""
    if resume and MESSAGES.is_terminal and not VERBOSITY.quiet:
        return MESSAGES.status("Comparing files with the report")
    return nullcontext()


def run_shown(batch: Batch, take: Callable[[FileResult], None] = lambda result: None) -> Tally:
    """Run a batch, pass each result to `take`, and print progress and, at the end, warnings."""
    tally = Tally()
    with (
        batch_progress(len(batch.jobs) + len(batch.done)) as on_result,
        closing(run_batch(batch, tally)) as results,  # ends the workers on an interrupt
    ):
        for result in results:
            on_result(result)
            take(result)
    _print_warnings(tally.warnings_by_kind()["warnings"], batch.report)
    return tally


def _print_warnings(groups: list[dict[str, Any]], report: Path) -> None:
    """Print warnings with the names of their files; only the first few without --verbose."""
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
