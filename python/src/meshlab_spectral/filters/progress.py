"""What `progress=` shows: True is a bar in a notebook or on a terminal, elsewhere a few lines."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from meshlab_spectral.errors import OptionError

if TYPE_CHECKING:
    from rich.console import Console

Progress = Callable[[str, float], object]
# Called with a stage, and the fraction of it that is done, 0 to 1, or None if unknown.
StageCallback = Callable[[str, float | None], object]

# Between plain lines; a shorter run prints none.
SECONDS_BETWEEN = 5.0


@contextlib.contextmanager
def progress_callback(progress: Progress | bool | None) -> Iterator[Progress | None]:
    """Yield what the core calls: `progress` itself, or what shows it if that is True.

    Without rich, which only the command needs, a terminal gets lines, too.
    """
    if progress is None:
        yield None
    elif callable(progress):
        yield _answered(progress)
    elif not isinstance(progress, bool):
        raise OptionError(f"progress = {progress!r}: pass True, or a function")
    elif not progress:
        yield None
    elif _is_notebook():
        with _notebook_bar() as update:
            yield update
    elif sys.stderr.isatty() and find_spec("rich") is not None:
        from rich.console import Console

        with terminal_bar(Console(stderr=True)) as update:
            yield update
    else:
        yield lines_now_and_then(lambda line: print(line, file=sys.stderr, flush=True))


def _answered(progress: Progress) -> Progress:
    """Return `progress` with a bool as its answer, also where that is one of NumPy."""

    def update(stage: str, fraction: float) -> bool:
        answer = progress(stage, fraction)
        is_bool = isinstance(answer, bool) or str(getattr(answer, "dtype", "")) == "bool"
        return not is_bool or bool(answer)

    return update


@contextlib.contextmanager
def terminal_bar(
    console: Console, *, is_transient: bool = False, is_quiet: bool = False
) -> Iterator[StageCallback]:
    """Show a bar, which disappears at the end if it is transient."""
    from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    with Bar(
        SpinnerColumn(),
        BarColumn(),
        TextColumn("{task.description}", markup=False),
        TimeElapsedColumn(),
        console=console,
        transient=is_transient,
        disable=is_quiet,
    ) as bar:
        task = bar.add_task("starting", total=None)

        def update(stage: str, fraction: float | None) -> None:
            if fraction is None:
                bar.reset(task, start=False, total=None, description=stage)
                bar.start_task(task)
            else:
                # The fraction may drop a little when a step turns out to need more work.
                done = max(fraction, bar.tasks[0].completed)
                bar.update(task, total=1.0, completed=done, description=stage)

        yield update


def lines_now_and_then(tell: Callable[[str], None]) -> StageCallback:
    """Return what tells the progress as a line every few seconds."""
    begin = last = time.monotonic()

    def update(stage: str, fraction: float | None) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= SECONDS_BETWEEN:
            last = now
            done = "" if fraction is None else f", {fraction:.0%}"
            tell(f"[{now - begin:.0f} s] {stage}{done}")

    return update


def _is_notebook() -> bool:
    """Whether output goes to cells: IPython runs in a kernel, not in a terminal."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return getattr(shell, "kernel", None) is not None


@contextlib.contextmanager
def _notebook_bar() -> Iterator[StageCallback]:
    """Show a bar of HTML, which needs no widgets."""
    from IPython.display import HTML, display

    begin = time.monotonic()

    def bar(stage: str, fraction: float | None) -> Any:
        value = "" if fraction is None else f" value='{fraction:.3f}'"
        seconds = time.monotonic() - begin
        return HTML(f"<progress max='1'{value}></progress> {stage}, {seconds:.1f} s")

    handle = display(bar("starting", None), display_id=True)
    try:
        yield lambda stage, fraction: handle.update(bar(stage, fraction))
    except BaseException:
        handle.update(bar("stopped", 0.0))
        raise
    handle.update(bar("done", 1.0))
