"""The memory that the plugin may use: one setting for the whole process."""

from __future__ import annotations

import os

from meshlab_spectral.errors import OptionError

# The plugin reads it whenever a filter starts.
VARIABLE = "MESHLAB_SPECTRAL_MEMORY"


def set_memory_limit(limit: int | None) -> None:
    """Limit the resident memory of this process, for all filters of the plugin started from now on.

    A filter that would need more is refused with the numbers, before it takes the memory. The limit
    is stored in the environment variable MESHLAB_SPECTRAL_MEMORY, so child processes inherit it.

    Parameters
    ----------
    limit
        Bytes, above zero, what the process has already taken included; None, the default: as much
        as the system has free.

    Raises
    ------
    OptionError
        When `limit` is not above zero.
    """
    if limit is None:
        os.environ.pop(VARIABLE, None)
    elif limit <= 0:
        raise OptionError(f"memory limit = {limit}: give a number of bytes above zero, or None")
    else:
        os.environ[VARIABLE] = str(limit)
