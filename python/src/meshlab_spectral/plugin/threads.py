"""Number of threads the plugin uses: one setting for the whole process."""

from __future__ import annotations

import os

from meshlab_spectral.errors import OptionError

# The plugin reads it whenever a filter starts.
VARIABLE = "MESHLAB_SPECTRAL_THREADS"


def set_threads(count: int | None) -> None:
    """Set the number of threads for all filters of the plugin started from now on.

    Results do not depend on it. It is stored in the environment variable MESHLAB_SPECTRAL_THREADS,
    so child processes inherit it.

    Parameters
    ----------
    count
        At least 1; None, the default, for one thread per processor.

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
    """Return the number set by `set_threads` or the environment; None: one per processor."""
    text = os.environ.get(VARIABLE)
    if text is None:
        return None
    if not text.isdecimal() or int(text) < 1:
        raise OptionError(f"the environment variable {VARIABLE} = {text}: must be above zero")
    return int(text)


def threads_each(processes: int) -> int:
    """Return the number of threads for each of several processes running at the same time."""
    return max(1, (threads() or os.cpu_count() or 1) // processes)
