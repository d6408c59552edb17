"""The MeshLab processes of a batch: reused, and replaced before they leak too much memory."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from meshlab_spectral.errors import MemoryLimitError, ProcessDiedError
from meshlab_spectral.plugin.limits import threads_each
from meshlab_spectral.workers.process import Answer, JobLimits, MeshLabProcess

# pymeshlab leaks memory: a process is replaced after this many jobs, or when it holds more than
# this share of its memory limit while idle.
_JOBS_PER_PROCESS = 250
_IDLE_SHARE = 0.5
# If its process dies, a job gets a second try in a new one: an earlier job may be to blame.
_ATTEMPTS = 2


class ProcessesEndedError(Exception):
    """The batch is over: there is no process for another job."""


class Processes:
    """A pool of MeshLab processes, for jobs in several threads.

    At most `at_once` of them share the threads of the plugin. `limits` are those of a job, `folder`
    is for copies of files at URLs.
    """

    def __init__(self, at_once: int, limits: JobLimits, folder: Path) -> None:
        self.limits, self.folder = limits, folder
        self._at_once = at_once
        self._turns = threading.BoundedSemaphore(at_once)
        self._lock = threading.Lock()
        self._idle: list[MeshLabProcess] = []
        self._working: list[MeshLabProcess] = []
        self._ended = False

    @contextlib.contextmanager
    def one(self) -> Iterator[MeshLabProcess]:
        """Yield a process for one job, once there is one.

        Raises ProcessStartError, and ProcessesEndedError after `end`.
        """
        with self._turns:
            process = self._take()
            try:
                yield process
            except ProcessDiedError:
                if self._ended:
                    raise ProcessesEndedError from None
                raise
            finally:
                self._give_back(process)

    def run(
        self,
        work: dict[str, Any],
        seconds: float | None = None,
        counts: dict[str, Any] | None = None,
    ) -> Answer:
        """Do the work of a job, twice if its process dies.

        Counts the "attempts", and adds the seconds of waiting to "waited", in `counts`. Raises what
        `one` and `MeshLabProcess.run` raise.
        """
        limits = replace(self.limits, seconds=seconds)
        counts = {"waited": 0.0} if counts is None else counts
        for attempt in range(1, _ATTEMPTS + 1):
            counts["attempts"] = attempt
            begin = time.monotonic()
            with self.one() as process:
                counts["waited"] += time.monotonic() - begin
                try:
                    return process.run(work, limits=limits)
                except (ProcessDiedError, MemoryLimitError):
                    if attempt == _ATTEMPTS:
                        raise
        raise AssertionError("unreachable")

    def end(self) -> None:
        """End the processes, whatever they are doing; there are no others from now on."""
        with self._lock:
            self._ended = True
            for process in self._working:
                process.kill()  # its thread ends it
            while self._idle:
                self._idle.pop().end()

    def _take(self) -> MeshLabProcess:
        with self._lock:
            if self._ended:
                raise ProcessesEndedError
            while self._idle:
                process = self._idle.pop()
                if process.is_alive:
                    break
                process.end()  # killed while it had nothing to do
            else:
                process = MeshLabProcess(threads_each(self._at_once))
            self._working.append(process)
            return process

    def _give_back(self, process: MeshLabProcess) -> None:
        limit = process.memory_limit
        grown = limit is not None and process.memory() > _IDLE_SHARE * limit
        reusable = process.usable and process.jobs < _JOBS_PER_PROCESS and not grown
        with self._lock:
            self._working.remove(process)
            if reusable and not self._ended:
                self._idle.append(process)
                return
        process.end()
