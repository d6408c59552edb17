"""What Ctrl-C does, and SIGTERM (kill, shutdown): light, for the first thing that is imported."""

from __future__ import annotations

import os
import signal
from typing import Any

EXIT_INTERRUPTED = 130


def end_at_once() -> None:
    """End the process quietly: while it is importing there is nothing to clean up."""
    _handle_with(_end)


def raise_interrupts() -> None:
    """Raise KeyboardInterrupt, for the work to be cleaned up."""
    _handle_with(signal.default_int_handler)


def ignore_interrupts() -> None:
    """Let nothing disturb the end of a process that has done its work."""
    _handle_with(signal.SIG_IGN)


def _handle_with(handler: Any) -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:  # as in a background job of a shell
            signal.signal(number, handler)


def _end(number: int, frame: object) -> None:
    os.write(2, b"Interrupted: no output was written.\n")
    os._exit(EXIT_INTERRUPTED)
