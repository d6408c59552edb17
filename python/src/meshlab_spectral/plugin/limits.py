"""Limits of the plugin, threads and memory: one setting each for the whole process."""

from __future__ import annotations

import math
import os
import re
from numbers import Integral, Real

from meshlab_spectral.errors import OptionError

# The plugin reads them whenever a filter starts.
THREADS, MEMORY = "MESHLAB_SPECTRAL_THREADS", "MESHLAB_SPECTRAL_MEMORY"
_SIZE = re.compile(r"(?P<number>\d*\.?\d+(e\+?\d+)?)\s*(?P<unit>[KMGT]?)(i?B)?", re.IGNORECASE)
_UNITS = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}
# What has set the limit of memory: texts name that, unless the environment has another since.
_SETTER = {"value": "", "name": ""}


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
    checked_threads(count)
    _set(THREADS, count)


def set_memory_limit(limit: int | None) -> None:
    """Limit the resident memory of this process, for all filters of the plugin started from now on.

    A filter that would need more is refused, with the numbers, before it allocates the memory. The
    limit is stored in the environment variable MESHLAB_SPECTRAL_MEMORY, so child processes inherit
    it.

    Parameters
    ----------
    limit
        Bytes, above zero, including what the process already uses; None, the default: as much as
        the system has free.

    Raises
    ------
    OptionError
        When `limit` is not above zero.
    """
    if limit is not None and not (isinstance(limit, Real) and 0 < limit < math.inf):
        raise OptionError(f"memory limit = {limit}: give a number of bytes above zero, or None")
    _set(MEMORY, limit)
    name_memory_limit("set_memory_limit")


def name_memory_limit(name: str) -> None:
    """Let texts call the limit that was just set so, such as the option of a command."""
    _SETTER.update(value=os.environ.get(MEMORY, ""), name=name)


def memory_remedy(needed: float | None = None) -> str:
    """Say how to raise the limit of `given_memory_limit`, to bytes that are needed if known."""
    text = os.environ.get(MEMORY)
    size = "" if needed is None else f" to at least {math.ceil(needed / 2**20)}MB"
    if text is None:
        return f"give it a machine with{size.removeprefix(' to at least')} more free memory"
    if text == _SETTER["value"]:
        return f"raise {_SETTER['name']}{size}"
    in_bytes = "" if needed is None else f" to at least {needed:.2g} bytes"
    return f"raise or unset the environment variable {MEMORY}{in_bytes}"


def checked_threads(count: int | None) -> int | None:
    """Return a number of threads, or None; raise OptionError unless it is an integer above zero."""
    if count is not None and not (isinstance(count, Integral) and 0 < count < 1 << 31):
        raise OptionError(f"threads = {count}: give a number of threads above zero, or None")
    return count


def _set(variable: str, number: int | None) -> None:
    if number is None:
        os.environ.pop(variable, None)
    else:
        os.environ[variable] = str(number)


def threads() -> int | None:
    """Return the number set by `set_threads` or the environment; None: one per processor."""
    text = os.environ.get(THREADS)
    if text is None:
        return None
    if not text.isdecimal() or int(text) < 1:
        raise OptionError(
            f"the environment variable {THREADS} = {text}: give a number of threads above zero, or "
            "unset it"
        )
    return int(text)


def given_memory_limit() -> int | None:
    """Return the limit in bytes set by `set_memory_limit` or the environment; None: no limit."""
    text = os.environ.get(MEMORY)
    if text is None:
        return None
    size = byte_count(text)
    if size is None:
        raise OptionError(
            f"the environment variable {MEMORY} = {text}: give a number of bytes above zero, such "
            "as 4e9 or 4GB, or unset it"
        )
    return size


def byte_count(text: str) -> int | None:
    """Return the number of bytes in a text such as 4GB or 4e9; None if it is none above zero."""
    match = _SIZE.fullmatch(text.strip())
    number = float(match["number"]) * _UNITS[match["unit"].upper()] if match else 0.0
    return max(1, int(number)) if 0 < number < math.inf else None


def threads_each(processes: int) -> int:
    """Return the number of threads for each of several processes running at the same time."""
    return max(1, (threads() or os.cpu_count() or 1) // processes)
