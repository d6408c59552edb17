"""How many threads the plugin computes with: one setting for the whole program."""

from __future__ import annotations

import os

from meshlab_spectral.errors import OptionError

# The plugin reads it when a filter begins.
VARIABLE = "MESHLAB_SPECTRAL_THREADS"


def set_threads(count: int | None) -> None:
    """Have all filters of the plugin that begin from now on compute with so many threads.

    Results do not depend on it. Processes that are started from here inherit it: it is the
    environment variable MESHLAB_SPECTRAL_THREADS.

    Parameters
    ----------
    count
        At least 1; None for one thread for each processor, as without a setting.

    Raises
    ------
    OptionError
        When `count` is below 1.
    """
    if count is None:
        os.environ.pop(VARIABLE, None)
    elif count < 1:
        raise OptionError(f"threads = {count}: give a number of threads above zero, or None")
    else:
        os.environ[VARIABLE] = str(count)


def threads() -> int | None:
    """Tell what `set_threads` or the environment has set; None for one for each processor."""
    text = os.environ.get(VARIABLE)
    if text is None:
        return None
    if not text.isdecimal() or int(text) < 1:
        raise OptionError(f"the environment variable {VARIABLE} = {text}: must be above zero")
    return int(text)


def threads_each(processes: int) -> int:
    """Give the share of each of some processes that compute at the same time on this machine."""
    return max(1, (threads() or os.cpu_count() or 1) // processes)
