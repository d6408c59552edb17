"""The MeshLab processes of a batch: reused, and replaced before they leak too much memory."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from pathlib import Path

from meshlab_spectral.errors import ProcessDiedError
from meshlab_spectral.plugin.limits import threads_each
from meshlab_spectral.process.parent import JobLimits, MeshLabProcess

# pymeshlab leaks memory: a process is replaced after this many jobs, or when it holds more than
# this share of its memory limit while idle.
_JOBS_PER_PROCESS = 250
_IDLE_SHARE = 0.5


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
