"""The MeshLab processes of a worker: reused, and replaced before they leak too much memory."""

from __future__ import annotations

import atexit
import contextlib
import threading
from collections.abc import Iterator

from meshlab_spectral.process.parent import JobLimits, MeshLabProcess

# pymeshlab leaks memory: a process is replaced after this many jobs, or when it holds more than
# this share of its memory limit while idle.
_JOBS_PER_PROCESS = 250
_IDLE_SHARE = 0.5


class Processes:
    """A pool of MeshLab processes, for the concurrent jobs of a worker.

    Attributes
    ----------
    at_once
        Maximum number of processes working at once; None: no limit.
    threads
        Number of threads for the plugin in each process; None: not set yet.
    """

    def __init__(self) -> None:
        self.at_once: int | None = None
        self.threads: int | None = None
        self._turns: contextlib.AbstractContextManager[object] = contextlib.nullcontext()
        self._lock = threading.Lock()
        self._idle: list[MeshLabProcess] = []

    def limit(self, at_once: int) -> None:
        """Set the maximum number of processes working at once. Call it before the first job."""
        self.at_once = at_once
        self._turns = threading.BoundedSemaphore(at_once)

    @contextlib.contextmanager
    def one(self, limits: JobLimits) -> Iterator[MeshLabProcess]:
        """Yield a process for one job, once the limit allows it."""
        with self._turns:
            process = self._take()
            try:
                yield process
            finally:
                self._give_back(process, limits)

    def end(self) -> None:
        """End the idle processes."""
        with self._lock:
            while self._idle:
                self._idle.pop().end()

    def _take(self) -> MeshLabProcess:
        with self._lock:
            if self._idle:
                return self._idle.pop()
        return MeshLabProcess(self.threads)

    def _give_back(self, process: MeshLabProcess, limits: JobLimits) -> None:
        grown = limits.memory is not None and process.memory() > _IDLE_SHARE * limits.memory
        if process.usable and process.jobs < _JOBS_PER_PROCESS and not grown:
            with self._lock:
                self._idle.append(process)
        else:
            process.end()


processes = Processes()
atexit.register(processes.end)
