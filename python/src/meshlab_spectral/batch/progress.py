"""How far a batch is: a live display on a terminal, elsewhere a line for what went wrong."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.markup import escape
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from meshlab_spectral.batch.jobs import FileResult


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
        TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(),
        TextColumn("left:"),
        TimeRemainingColumn(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
        redirect_stdout=False,
    ) as progress:
        task = progress.add_task("", total=files, failed="0 failed", rate="")
        begin = time.monotonic()
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
            rate = worked / max(time.monotonic() - begin, 1e-3)
            told = f"[red]{failed} failed[/red]" if failed else "0 failed"
            progress.update(task, advance=1, failed=told, rate=f"{rate:.1f} files/s")

        yield update
