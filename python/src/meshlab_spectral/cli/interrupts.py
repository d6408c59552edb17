"""Handling of Ctrl-C and SIGTERM (kill, shutdown); imported first, so it imports little itself."""

from __future__ import annotations

import os
import signal
from typing import Any

EXIT_INTERRUPTED = 130


def end_at_once() -> None:
    """On an interrupt, end the process at once: during imports there is nothing to clean up."""
    _handle_with(_end)


def raise_interrupts() -> None:
    """On an interrupt, raise KeyboardInterrupt, so that unfinished work is cleaned up."""
    _handle_with(signal.default_int_handler)


def ignore_interrupts() -> None:
    """Ignore interrupts: the process has done its work and is about to exit."""
    _handle_with(signal.SIG_IGN)


def _handle_with(handler: Any) -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:  # a shell's background jobs ignore it
            signal.signal(number, handler)


def _end(number: int, frame: object) -> None:
    os.write(2, b"Interrupted: no output was written.\n")
    os._exit(EXIT_INTERRUPTED)
