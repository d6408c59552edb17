"""The child process that runs MeshLab, seen from its parent.

MeshLab cannot be interrupted, reports progress only on standard error, and takes its whole process
down when it crashes. In a child process (see `child`) it can be watched and ended, and even a crash
becomes an error with a message.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import selectors
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from meshlab_spectral import errors
from meshlab_spectral.plugin.threads import VARIABLE as THREADS_VARIABLE

ProgressCallback = Callable[[str, float | None], None]

_LOG_LINE = re.compile(r"^LOG: \d+ (?P<stage>.*?)\s+\[ (?P<percent>\d+)% \]")
_KEPT_LOG_LINES = 30
# Seconds between checks of the limits, in which memory can grow by some 100 MB.
_LOOK_INTERVAL = 0.05
_PAGE = os.sysconf("SC_PAGE_SIZE")
# By default glibc returns the memory of every matrix to the system and requests it again for the
# next one, which costs a tenth of the time for a small mesh, a fifth with two processes. These
# settings keep up to 128 MiB.
_ALLOCATOR = {
    "MALLOC_MMAP_THRESHOLD_": str(32 * 2**20),
    "MALLOC_TRIM_THRESHOLD_": str(128 * 2**20),
}


@dataclass(frozen=True)
class JobLimits:
    """Limits of a job, beyond which its process is ended.

    Attributes
    ----------
    memory
        Resident memory of the process in bytes; None: no limit.
    seconds
        Time since the start of the job; None: no limit.
    """

    memory: int | None = None
    seconds: float | None = None


NO_LIMITS = JobLimits()


@dataclass(frozen=True)
class Answer:
    """Result of a job: the filter's report and the peak memory of the process in bytes."""

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
        environment = {**os.environ, **_ALLOCATOR}  # Dask workers have opposite settings
        if threads is not None:
            environment[THREADS_VARIABLE] = str(threads)
        lifeline, self._lifeline = os.pipe()
        try:
            self._child = subprocess.Popen(
                [sys.executable, "-m", "meshlab_spectral.process.child", str(lifeline)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                pass_fds=[lifeline],
                env=environment,
            )
        except BaseException:
            os.close(self._lifeline)
            raise
        finally:
            os.close(lifeline)
        self._log: list[str] = []
        self._on_progress: ProgressCallback = _ignore
        self._answer: dict[str, Any] | None = None
        self._streams = selectors.DefaultSelector()
        for stream, take in (
            (self._child.stdout, self._take_answer),
            (self._child.stderr, self._take_log),
        ):
            assert stream is not None
            os.set_blocking(stream.fileno(), False)
            self._streams.register(stream, selectors.EVENT_READ, _Lines(take))
        self.jobs = 0
        self.usable = True

    def __enter__(self) -> MeshLabProcess:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.end()

    def run(
        self,
        job: dict[str, Any],
        on_progress: ProgressCallback | None = None,
        limits: JobLimits = NO_LIMITS,
    ) -> Answer:
        """Do a job.

        Parameters
        ----------
        job
            As `child` expects it.
        on_progress
            Called with the current stage and the fraction done, 0 to 1, or None if unknown.
        limits
            Limits for this job.

        Raises
        ------
        SpectralError
            When the filter, or reading or writing a file, failed in the child.
        ProcessDiedError
            When the child died without an answer.
        TimeLimitError, MemoryLimitError
            When the child exceeded a limit and was ended.
        """
        self._log.clear()
        self._answer = None
        self._on_progress = on_progress or _ignore
        self.jobs += 1
        self.usable = False  # until the job has succeeded
        assert self._child.stdin is not None
        with contextlib.suppress(BrokenPipeError):  # the child has died: reported below
            # The plugin refuses what it knows to need more; what it does not know of is seen here.
            limited = {**job, "memory": limits.memory}
            self._child.stdin.write(json.dumps(limited).encode() + b"\n")
            self._child.stdin.flush()
        answer = self._await_answer(limits)
        if limits.memory is not None and answer.get("error") == "MemoryLimitError":
            raise _too_much_memory(limits.memory, answer["message"])
        if "error" in answer:
            raise _error_of(answer)
        self.usable = True
        return Answer(answer["report"], answer["peak_memory"])

    def end(self) -> None:
        """End the child, whatever it is doing."""
        self._child.kill()
        self._child.wait()
        self._streams.close()
        for stream in (self._child.stdin, self._child.stdout, self._child.stderr):
            assert stream is not None
            with contextlib.suppress(BrokenPipeError):  # a job it never read
                stream.close()
        if self._lifeline >= 0:
            os.close(self._lifeline)
            self._lifeline = -1

    @property
    def pid(self) -> int:
        """Process id of the child."""
        return self._child.pid

    def memory(self) -> int:
        """Resident memory of the child in bytes; 0 if it is gone or this is unknown."""
        try:
            return _PAGE * int(Path(f"/proc/{self.pid}/statm").read_text().split()[1])
        except (OSError, IndexError):
            return 0

    def _await_answer(self, limits: JobLimits) -> dict[str, Any]:
        begin = time.monotonic()
        limited = limits != NO_LIMITS
        while self._answer is None:
            for key, _ in self._streams.select(_LOOK_INTERVAL if limited else None):
                part = os.read(key.fd, 65536)
                if part:
                    key.data.feed(part)
                else:
                    self._streams.unregister(key.fileobj)
            if self._answer is None and not self._streams.get_map():
                raise self._death()
            if self._answer is None and limited:
                self._enforce(limits, time.monotonic() - begin)
        return self._answer

    def _enforce(self, limits: JobLimits, seconds: float) -> None:
        if limits.seconds is not None and seconds > limits.seconds:
            self._child.kill()
            raise errors.TimeLimitError(
                f"not done after {limits.seconds:g} seconds, the time limit: raise the limit, or "
                "check the mesh"
            )
        if limits.memory is not None and self.memory() > limits.memory:
            self._child.kill()
            raise _too_much_memory(limits.memory, "the file may be damaged")

    def _death(self) -> errors.ProcessDiedError:
        status = self._child.wait()
        how = f"by signal {signal.Signals(-status).name}" if status < 0 else f"with status {status}"
        error = errors.ProcessDiedError(
            f"the process running MeshLab was ended {how} before it had finished. Unless that was "
            "intentional, the mesh may need more memory than available, or have hit a bug in "
            "MeshLab or this filter: please report it, with the mesh"
        )
        tail = "\n".join(self._log)
        error.__cause__ = RuntimeError(f"the last lines of its log:\n{tail}")
        return error

    def _take_answer(self, line: str) -> None:
        content = json.loads(line)
        if "stage" in content:
            self._on_progress(content["stage"], None)
        else:
            self._answer = content

    def _take_log(self, line: str) -> None:
        self._log.append(line.rstrip())
        del self._log[:-_KEPT_LOG_LINES]
        match = _LOG_LINE.match(line)
        if match:
            self._on_progress(match["stage"], int(match["percent"]) / 100)


class _Lines:
    """Assembles lines from the chunks read from a pipe."""

    def __init__(self, take: Callable[[str], None]) -> None:
        self._take = take
        self._rest = b""

    def feed(self, part: bytes) -> None:
        *lines, self._rest = (self._rest + part).split(b"\n")
        for line in lines:
            self._take(line.decode("utf-8", errors="replace"))


def _ignore(stage: str, fraction: float | None) -> None:
    """Ignore progress."""


def _too_much_memory(limit: int, detail: str) -> errors.MemoryLimitError:
    return errors.MemoryLimitError(
        f"needs more than {limit / 2**20:.0f} MiB of memory, the limit of a worker: raise the "
        f"memory limit, with fewer workers if need be; {detail}"
    )


def _error_of(answer: dict[str, Any]) -> errors.SpectralError:
    kind = getattr(errors, answer["error"], errors.FilterError)
    error: errors.SpectralError = kind(answer["message"])
    # For --debug: where it happened in the child.
    error.__cause__ = RuntimeError(answer["traceback"])
    return error
