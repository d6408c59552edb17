"""Waiting for conditions, never for times: a slow machine only takes longer."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

# Long enough that only what never happens takes so long.
PATIENCE_SECONDS = 120.0
PAUSE_SECONDS = 0.05

Result = TypeVar("Result")


def wait_for(
    what: str, condition: Callable[[], Result | None], patience: float = PATIENCE_SECONDS
) -> Result:
    """Call `condition` until it returns something true, and return that."""
    end = time.monotonic() + patience
    while True:
        result = condition()
        if result:
            return result
        if time.monotonic() > end:
            raise AssertionError(f"waited {patience:g} s in vain for {what}")
        time.sleep(PAUSE_SECONDS)
