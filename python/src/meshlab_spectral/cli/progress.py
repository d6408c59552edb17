"""Progress on a terminal: of one mesh, and of a batch."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator
from datetime import timedelta

from rich.console import Console
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

from meshlab_spectral.batch.jobs import FileResult
from meshlab_spectral.cli.messages import MESSAGES
from meshlab_spectral.process.parent import ProgressCallback

_FEWEST_PER_SECOND = 0.1


@contextlib.contextmanager
def progress_shown() -> Iterator[ProgressCallback]:
    """Show on a terminal what MeshLab reports of its progress; elsewhere nothing."""
    with Progress(
        SpinnerColumn(),
        BarColumn(),
        TextColumn("{task.description}", markup=False),
        TimeElapsedColumn(),
        console=MESSAGES,
        transient=True,
        disable=not MESSAGES.is_terminal,
    ) as progress:
        task = progress.add_task("starting", total=None)

        def update(stage: str, fraction: float | None) -> None:
            if fraction is None:
                progress.reset(task, start=False, total=None, description=stage)
                progress.start_task(task)
            else:
                # MeshLab's figure may fall back a little when a step turns out to need more work.
                done = max(fraction, progress.tasks[0].completed)
                progress.update(task, total=1.0, completed=done, description=stage)

        yield update


@contextlib.contextmanager
def batch_progress(console: Console, files: int) -> Iterator[Callable[[FileResult], None]]:
    """Show on a terminal how many files are done and failed, the rate and the time left.

    Failures are told everywhere, a line each.

    Parameters
    ----------
    console
        Where to.
    files
        How many results there will be.

    Yields
    ------
    callable
        To be called with every result.
    """
    with Progress(
        SpinnerColumn(),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[failed]}"),
        TimeElapsedColumn(),
        _PaceColumn(table_column=Column(no_wrap=True)),  # a narrow terminal shortens the bar
        console=console,
        transient=True,
        disable=not console.is_terminal,
        redirect_stdout=False,
    ) as progress:
        task = progress.add_task("", total=files, failed="0 failed", worked=0)
        worked = failed = 0

        def update(result: FileResult) -> None:
            nonlocal worked, failed
            if result.outcome == "failed":
                failed += 1
                reason = result.reason or ""
                named = reason if result.input in reason else f"{result.input}: {reason}"
                console.print(
                    f"[red]Failed:[/red] {escape(named)}",
                    highlight=False,
                    soft_wrap=True,
                )
            worked += result.outcome != "unchanged"
            told = f"[red]{failed} failed[/red]" if failed else "0 failed"
            progress.update(task, advance=1, failed=told, worked=worked)

        yield update


class _PaceColumn(ProgressColumn):
    """Rate and time left; rich's own would count the files that an earlier run has done."""

    def render(self, task: Task) -> Text:
        worked = task.fields["worked"]
        if not worked or not task.elapsed or task.remaining is None:
            return Text("")
        rate = worked / task.elapsed
        told = f"{rate:.1f} files/s" if rate >= _FEWEST_PER_SECOND else f"{60 * rate:.1f} files/min"
        left = timedelta(seconds=math.ceil(task.remaining / rate))
        return Text(f"{told}, {left} left")
