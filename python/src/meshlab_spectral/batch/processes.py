"""MeshLab's processes of one worker: used again and again, replaced before they leak much."""

from __future__ import annotations

import atexit
import contextlib
import threading
from collections.abc import Iterator

from meshlab_spectral.process.parent import JobLimits, MeshLabProcess

# pymeshlab leaks: a process is replaced after so many meshes, or when it holds more than this part
# of what it may with nothing to do.
_JOBS_PER_PROCESS = 250
_IDLE_SHARE = 0.5


class Processes:
    """MeshLab's processes of a worker, for as many jobs at once as it has threads, or fewer.

    Attributes
    ----------
    at_once
        How many may work at the same time; None: any number.
    threads
        That the plugin computes with in each of them; None: not said yet.
    """

    def __init__(self) -> None:
        self.at_once: int | None = None
        self.threads: int | None = None
        self._turns: contextlib.AbstractContextManager[object] = contextlib.nullcontext()
        self._lock = threading.Lock()
        self._idle: list[MeshLabProcess] = []

    def limit(self, at_once: int) -> None:
        """Let only so many work at the same time. To be called before the first job."""
        self.at_once = at_once
        self._turns = threading.BoundedSemaphore(at_once)

    @contextlib.contextmanager
    def one(self, limits: JobLimits) -> Iterator[MeshLabProcess]:
        """Give a process for one job, as soon as one may work."""
        with self._turns:
            process = self._take()
            try:
                yield process
            finally:
                self._give_back(process, limits)

    def end(self) -> None:
        """End the processes that have nothing to do."""
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
