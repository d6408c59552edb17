"""The child process that runs MeshLab, seen from its parent.

MeshLab cannot be interrupted, reports progress only on standard error, and takes its whole process
down when it crashes. In a child process (see `child`) it can be watched and ended, and even a crash
becomes an error with a message.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from meshlab_spectral import errors
from meshlab_spectral.plugin.limits import MEMORY, THREADS, given_memory_limit

ProgressCallback = Callable[[str, float | None], None]

# Receives MeshLab's log, except for its progress.
LOG = logging.getLogger("meshlab_spectral.meshlab")

_LOG_BEGIN = re.compile(r"^LOG: \d+ ")
_LOG_LINE = re.compile(_LOG_BEGIN.pattern + r"(?P<stage>.*?)\s+\[ (?P<percent>\d+)% \]")
_KEPT_LOG_LINES = 30
# Seconds between polls of the child, within which its memory can grow by some 100 MB.
_LOOK_INTERVAL = 0.05
# By default glibc returns the memory of every matrix to the system and requests it again for the
# next one, which is slow for small meshes, more so with several processes. These settings keep up
# to 128 MiB.
_ALLOCATOR = {
    "MALLOC_MMAP_THRESHOLD_": str(32 * 2**20),
    "MALLOC_TRIM_THRESHOLD_": str(128 * 2**20),
}


@dataclass(frozen=True)
class JobLimits:
    """Limits of a job, beyond which its process is killed.

    Attributes
    ----------
    memory
        Resident memory of the process in bytes; None: that of the environment, if any.
    seconds
        Time since the start of the job; None: no limit.
    """

    memory: int | None = None
    seconds: float | None = None


NO_LIMITS = JobLimits()


@dataclass(frozen=True)
class Answer:
    """Result of a job: the filter's report and the peak memory of the process in bytes.

    The peak is that of samples taken at least every 0.05 s.
    """

    report: dict[str, Any]
    peak_memory: int


class MeshLabProcess:
    """A child process that does jobs one at a time.

    It cannot be used again after an error: pymeshlab may crash or hang once a filter has failed in
    it. Use it as a context manager, or `end` it.

    Parameters
    ----------
    threads
        Number of threads for the plugin; None: as in this process.
    """

    def __init__(self, threads: int | None = None) -> None:
        environment = {**os.environ, **_ALLOCATOR}  # Dask workers set the opposite
        if threads is not None:
            environment[THREADS] = str(threads)
        self._child = subprocess.Popen(
            [sys.executable, "-m", "meshlab_spectral.process.child"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            env=environment,
        )
        self._log: deque[str] = deque(maxlen=_KEPT_LOG_LINES)
        # Messages from the child: stages and the answer of a job; None at its end.
        self._messages: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._readers = [
            threading.Thread(target=read, daemon=True)
            for read in (self._read_answers, self._read_log)
        ]
        for reader in self._readers:
            reader.start()
        self.jobs = 0
        self.usable = True

    def __enter__(self) -> MeshLabProcess:
        return self

    def __exit__(self, *error: object) -> None:
        self.end()

    def run(
        self,
        job: dict[str, Any],
        on_progress: ProgressCallback | None = None,
        limits: JobLimits = NO_LIMITS,
    ) -> Answer:
        """Do a job, described as `child` expects it, within its limits.

        `on_progress` is called with the current stage and the fraction done, 0 to 1, or None if
        unknown.

        Raises
        ------
        SpectralError
            When the filter, or reading or writing a file, failed in the child.
        ProcessDiedError
            When the child died without an answer.
        TimeLimitError, MemoryLimitError
            When the child exceeded a limit and was ended.
        OptionError
            When the memory limit of the environment is invalid.
        """
        if limits.memory is None:
            limits = replace(limits, memory=given_memory_limit())
        self._log.clear()
        self.jobs += 1
        self.usable = False  # until the job has succeeded
        assert self._child.stdin is not None
        with contextlib.suppress(OSError):  # the child has died: reported below
            # The plugin refuses work beyond the limit; what it cannot foresee is caught below.
            self._child.stdin.write(json.dumps({**job, "memory": limits.memory}) + "\n")
            self._child.stdin.flush()
        answer, peak_memory = self._await_answer(on_progress or _ignore, limits)
        if limits.memory is not None and answer.get("error") == "MemoryLimitError":
            raise _too_much_memory(limits.memory, answer["message"])
        if "error" in answer:
            raise _error_of(answer)
        self.usable = True
        return Answer(answer["report"], peak_memory)

    def end(self) -> None:
        """End the child, whatever it is doing."""
        self._child.kill()
        self._await_end()
        for stream in (self._child.stdin, self._child.stdout, self._child.stderr):
            assert stream is not None
            with contextlib.suppress(OSError):  # a job it never read
                stream.close()

    @property
    def pid(self) -> int:
        """Process id of the child."""
        return self._child.pid

    def memory(self) -> int:
        """Resident memory of the child in bytes; 0 if it is gone."""
        import psutil  # a slow import, while the child is starting

        try:
            return int(psutil.Process(self.pid).memory_info().rss)
        except psutil.Error:
            return 0

    def _await_answer(
        self, on_progress: ProgressCallback, limits: JobLimits
    ) -> tuple[dict[str, Any], int]:
        """Return the answer to a job, and the peak memory during it."""
        begin = time.monotonic()
        peak_memory = 0
        while True:
            message: dict[str, Any] | None = {}
            with contextlib.suppress(queue.Empty):
                message = self._messages.get(timeout=_LOOK_INTERVAL)
            if message is None:
                raise self._death()
            memory = self.memory()
            peak_memory = max(peak_memory, memory)
            if "stage" in message:
                on_progress(message["stage"], message.get("fraction"))
            elif message:
                return message, peak_memory
            self._enforce(limits, time.monotonic() - begin, memory)

    def _enforce(self, limits: JobLimits, seconds: float, memory: int) -> None:
        if limits.seconds is not None and seconds > limits.seconds:
            self._child.kill()
            raise errors.TimeLimitError(
                f"not done after {limits.seconds:g} seconds, the time limit: raise the limit, or "
                "check the mesh"
            )
        if limits.memory is not None and memory > limits.memory:
            self._child.kill()
            raise _too_much_memory(limits.memory, "the file may be damaged")

    def _death(self) -> errors.ProcessDiedError:
        status = self._await_end()
        how = f"by signal {signal.Signals(-status).name}" if status < 0 else f"with status {status}"
        error = errors.ProcessDiedError(
            f"the process running MeshLab was ended {how} before it had finished. Unless that was "
            "intentional, the mesh may need more memory than available, or have hit a bug in "
            "MeshLab or this filter: please report it, with the mesh"
        )
        tail = "\n".join(self._log)
        error.__cause__ = RuntimeError(f"the last lines of its log:\n{tail}")
        return error

    def _await_end(self) -> int:
        """Return the exit status of the child, once everything that it sent has been read."""
        status = self._child.wait()
        for reader in self._readers:
            reader.join()
        return status

    def _read_answers(self) -> None:
        assert self._child.stdout is not None
        for line in self._child.stdout:
            if line.endswith("\n"):  # else the child was killed while writing
                self._messages.put(json.loads(line))
        self._messages.put(None)

    def _read_log(self) -> None:
        assert self._child.stderr is not None
        for line in self._child.stderr:
            self._log.append(line.rstrip())
            match = _LOG_LINE.match(line)
            if match:
                fraction = int(match["percent"]) / 100
                self._messages.put({"stage": match["stage"], "fraction": fraction})
            elif line.strip():
                LOG.info(_LOG_BEGIN.sub("", line.rstrip()))


def _ignore(stage: str, fraction: float | None) -> None:
    """Ignore progress."""


def _too_much_memory(limit: int, detail: str) -> errors.MemoryLimitError:
    which, remedy = "the limit of a worker", "raise the memory limit, with fewer workers if need be"
    if limit == given_memory_limit():
        which, remedy = "its limit", f"raise or unset the environment variable {MEMORY}"
    return errors.MemoryLimitError(
        f"needs more than {limit / 2**20:.0f} MiB of memory, {which}: {remedy}; {detail}"
    )


def _error_of(answer: dict[str, Any]) -> errors.SpectralError:
    kind = getattr(errors, answer["error"], errors.FilterError)
    error: errors.SpectralError = kind(answer["message"])
    # For --debug: where it happened in the child.
    error.__cause__ = RuntimeError(answer["traceback"])
    return error
