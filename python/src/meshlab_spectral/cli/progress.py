"""Progress of one mesh and of a batch: a display on a terminal, elsewhere plain lines."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator
from datetime import timedelta
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
)
from rich.table import Column
from rich.text import Text

from meshlab_spectral.cli.messages import MESSAGES, VERBOSITY, one_line, print_message
from meshlab_spectral.filters.progress import StageCallback, lines_now_and_then, terminal_bar

if TYPE_CHECKING:
    from meshlab_spectral.batch.jobs import FileResult

_FEWEST_PER_SECOND = 0.1


@contextlib.contextmanager
def progress_shown() -> Iterator[StageCallback]:
    """Show MeshLab's progress, on a terminal or as a line every few seconds; none with --quiet."""
    if MESSAGES.is_terminal:
        with terminal_bar(MESSAGES, is_transient=True, is_quiet=VERBOSITY.quiet) as update:
            yield update
    else:
        yield lines_now_and_then(lambda line: None if VERBOSITY.quiet else print_message(line))


@contextlib.contextmanager
def batch_progress(files: int) -> Iterator[Callable[[FileResult], None]]:
    """Show the progress of a batch of `files` results; pass each to the yielded function.

    On a terminal, shows the number of files done and failed, the rate and the time left; elsewhere,
    and with --verbose, a line per file; with --quiet, nothing. Failures are always printed.
    """
    with Progress(
        SpinnerColumn(),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[failed]}"),
        TimeElapsedColumn(),
        _PaceColumn(table_column=Column(no_wrap=True)),  # a narrow terminal shortens the bar
        console=MESSAGES,
        transient=True,
        disable=VERBOSITY.quiet or not MESSAGES.is_terminal,
        redirect_stdout=False,
    ) as progress:
        task = progress.add_task("", total=files, failed="0 failed", worked=0)
        has_lines = VERBOSITY.verbose or not (MESSAGES.is_terminal or VERBOSITY.quiet)
        done = worked = failed = 0

        def update(result: FileResult) -> None:
            nonlocal done, worked, failed
            done += 1
            if result.outcome == "failed":
                failed += 1
                reason = result.reason or ""
                named = reason if result.input in reason else f"{result.input}: {reason}"
                MESSAGES.print(
                    f"[red]Failed:[/red] {escape(one_line(named))}", highlight=False, soft_wrap=True
                )
            elif has_lines and result.outcome != "already done":  # these come all at once
                print_message(f"[{done}/{files}] {result.name}: {result.outcome}")
            worked += result.outcome != "already done"
            failures = f"[red]{failed} failed[/red]" if failed else "0 failed"
            progress.update(task, advance=1, failed=failures, worked=worked)

        yield update


class _PaceColumn(ProgressColumn):
    """Rate and time left; rich's own column would count the files done by an earlier run."""

    def render(self, task: Task) -> Text:
        worked = task.fields["worked"]
        if not worked or not task.elapsed or task.remaining is None:
            return Text("")
        rate = worked / task.elapsed
        pace = f"{rate:.1f} files/s" if rate >= _FEWEST_PER_SECOND else f"{60 * rate:.1f} files/min"
        left = timedelta(seconds=math.ceil(task.remaining / rate))
        return Text(f"{pace}, {left} left")
