"""The child process that runs MeshLab, seen from its parent.

MeshLab cannot be interrupted, reports progress only on standard error, and takes its whole process
down when it crashes. In a child process (see `child`) it can be watched and ended, and even a crash
becomes an error with a message.
"""

from __future__ import annotations

import base64
import contextlib
import json
import logging
import os
import pickle
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from dataclasses import dataclass
from typing import Any

from meshlab_spectral import errors
from meshlab_spectral.filters.progress import StageCallback
from meshlab_spectral.plugin.limits import THREADS, given_memory_limit, memory_remedy

# Receives MeshLab's log, except for its progress.
LOG = logging.getLogger("meshlab_spectral.meshlab")

_LOG_BEGIN = re.compile(r"^LOG: \d+ ")
_LOG_LINE = re.compile(_LOG_BEGIN.pattern + r"(?P<stage>.*?)\s+\[ (?P<percent>\d+)% \]")
_KEPT_LOG_LINES = 30
# Seconds between polls of the child, within which its memory can grow by some 100 MB.
_LOOK_INTERVAL = 0.05
_WORKER_REMEDY = "the limit of a worker: raise the memory limit, with fewer workers if need be"
# By default glibc returns the memory of every matrix to the system and requests it again for the
# next one, which is slow for small meshes, more so with several processes. These settings keep up
# to 128 MiB.
_ALLOCATOR = {
    "MALLOC_MMAP_THRESHOLD_": str(32 * 2**20),
    "MALLOC_TRIM_THRESHOLD_": str(128 * 2**20),
}


@dataclass(frozen=True)
class JobLimits:
    """Limits of a job, beyond which its process is killed; None: no limit."""

    memory: int | None = None  # resident, of the process, bytes
    seconds: float | None = None  # since the start of the job
    replaces_environment: bool = False  # whether a lower limit of the environment does not count


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

    `threads` is the number of threads for the plugin; None: as in this process. Raises
    ProcessStartError when it cannot be started.
    """

    def __init__(self, threads: int | None = None) -> None:
        self.jobs = 0
        self.usable = True
        self.memory_limit: int | None = None
        self._is_ready = self._is_verbose = False
        self._stage = ""  # of the job
        self._log: deque[str] = deque(maxlen=_KEPT_LOG_LINES)
        # Messages from the child: stages and the answer of a job; None at its end.
        self._messages: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._readers = [
            threading.Thread(target=read, daemon=True)
            for read in (self._read_answers, self._read_log)
        ]
        environment = {**os.environ, **_ALLOCATOR}  # Dask workers set the opposite
        if threads is not None:
            environment[THREADS] = str(threads)
        try:
            self._child = subprocess.Popen(
                [sys.executable, "-m", "meshlab_spectral.child"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                encoding="utf-8",
                errors="replace",
                env=environment,
            )
            for reader in self._readers:
                reader.start()
        except (OSError, RuntimeError) as error:  # RuntimeError: of a thread
            raise _not_started(f"cannot be started ({error})") from error

    def __enter__(self) -> MeshLabProcess:
        return self

    def __exit__(self, *error: object) -> None:
        self.end()

    def run(
        self,
        job: dict[str, Any],
        on_progress: StageCallback | None = None,
        limits: JobLimits = NO_LIMITS,
    ) -> Answer:
        """Do a job within its limits: "call", the name of a function of `child`, and its arguments.

        With a path as "result", what the call returns is pickled there. Raises the SpectralError of
        the call; ProcessDiedError when the child died without an answer, ProcessStartError if it
        was not ready yet; TimeLimitError or MemoryLimitError when it exceeded a limit and was
        ended; OptionError when the memory limit of the environment is invalid.
        """
        given = None if limits.replaces_environment else given_memory_limit()
        if given is not None and (limits.memory is None or given <= limits.memory):
            self.memory_limit, self._remedy = given, f"its limit: {memory_remedy()}"
        else:
            self.memory_limit, self._remedy = limits.memory, _WORKER_REMEDY
        if self._is_ready:  # else it says why the child did not start
            self._log.clear()
        self.jobs += 1
        self.usable = False  # until the job has succeeded
        self._is_verbose, self._stage = getattr(job.get("request"), "verbose", True), ""
        # The plugin refuses work beyond the memory limit; what it cannot foresee is caught below.
        line = as_text({**job, "memory": self.memory_limit}) + "\n"
        # In a thread: a long script fills the pipe, and the child may hang before it reads it.
        threading.Thread(target=self._send, args=[line], daemon=True).start()
        answer, peak_memory = self._await_answer(on_progress or _ignore, limits.seconds)
        if "error" in answer:
            error: errors.SpectralError = from_text(answer["error"])
            if self.memory_limit is not None and type(error) is errors.MemoryLimitError:
                raise self._too_much_memory(str(error))
            # For --debug: where it happened in the child.
            raise error from RuntimeError(answer["traceback"])
        self.usable = True
        return Answer(answer["report"], peak_memory)

    def kill(self) -> None:
        """Kill the child; a `run` in another thread then raises ProcessDiedError."""
        self._child.kill()

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

    @property
    def is_alive(self) -> bool:
        """Whether the child is running."""
        return self._child.poll() is None

    def memory(self) -> int:
        """Resident memory of the child in bytes; 0 if it is gone."""
        import psutil  # a slow import, while the child is starting

        try:
            return int(psutil.Process(self.pid).memory_info().rss)
        except psutil.Error:
            return 0

    def _await_answer(
        self, on_progress: StageCallback, time_limit: float | None
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
            if "ready" in message:
                self._is_ready = True
            elif "stage" in message:
                self._stage = message["stage"]
                on_progress(self._stage, message.get("fraction"))
            elif message:
                return message, peak_memory
            if time_limit is not None and time.monotonic() - begin > time_limit:
                self._child.kill()
                raise errors.TimeLimitError(
                    f"not done after {time_limit:g} seconds, the time limit: raise the limit, or "
                    "check the mesh"
                )
            if self.memory_limit is not None and memory > self.memory_limit:
                self._child.kill()
                raise self._too_much_memory(f"it had {memory / 2**20:.0f} MiB")

    def _too_much_memory(self, detail: str) -> errors.MemoryLimitError:
        limit = f"more than {(self.memory_limit or 0) / 2**20:.0f} MiB of memory"
        return errors.MemoryLimitError(f"needs {limit}, {self._remedy}; {detail}")

    def _death(self) -> errors.ProcessDiedError:
        status = self._await_end()
        how = f"by signal {signal.Signals(-status).name}" if status < 0 else f"with status {status}"
        if self._is_ready and self._stage == "reading":
            error = errors.ProcessDiedError(
                f"the file cannot be read: its reader was ended {how}. Unless that was "
                "intentional, it is damaged, or would take more memory or time than its size "
                "allows: export it again from the program that made it"
            )
        elif self._is_ready:
            error = errors.ProcessDiedError(
                f"the process running MeshLab was ended {how} before it had finished. Unless that "
                "was intentional, the mesh may need more memory than available, or have hit a bug "
                "in MeshLab or this filter: please report it, with the mesh"
            )
        else:
            last = f" ({self._log[-1]})" if self._log else ""
            error = _not_started(f"was ended {how} before it was ready{last}")
        tail = "\n".join(self._log)
        error.__cause__ = RuntimeError(f"the last lines of its log:\n{tail}")
        return error

    def _await_end(self) -> int:
        """Return the exit status of the child, once everything that it sent has been read."""
        status = self._child.wait()
        for reader in self._readers:
            reader.join()
        return status

    def _send(self, line: str) -> None:
        assert self._child.stdin is not None
        with contextlib.suppress(OSError, ValueError):  # the child has died: reported by `run`
            self._child.stdin.write(line)
            self._child.stdin.flush()

    def _read_answers(self) -> None:
        assert self._child.stdout is not None
        for line in self._child.stdout:
            message = None
            with contextlib.suppress(ValueError):
                message = json.loads(line)
            if isinstance(message, dict):  # else a library wrote it, or the child was killed midway
                self._messages.put(message)
        self._messages.put(None)

    def _read_log(self) -> None:
        assert self._child.stderr is not None
        for line in self._child.stderr:
            self._log.append(line.rstrip())
            match = _LOG_LINE.match(line)
            if match:
                fraction = int(match["percent"]) / 100
                self._messages.put({"stage": match["stage"], "fraction": fraction})
            elif line.strip() and self._is_verbose:
                LOG.info(_LOG_BEGIN.sub("", line.rstrip()))


_waiting: list[MeshLabProcess] = []


def start_ahead() -> None:
    """Start the process that `process_for_job` returns; what goes wrong is found there, again.

    While its command still imports: that saves a fifth of the time for a small mesh.
    """
    with contextlib.suppress(errors.ProcessStartError):
        _waiting.append(MeshLabProcess())


def process_for_job() -> MeshLabProcess:
    """Return the process that was started ahead, else a new one."""
    return _waiting.pop() if _waiting else MeshLabProcess()


def end_unused() -> None:
    """End the process that no job has asked for, as after an invalid option."""
    while _waiting:
        _waiting.pop().end()


def _ignore(stage: str, fraction: float | None) -> None:
    """Ignore progress."""


def _not_started(how: str) -> errors.ProcessStartError:
    return errors.ProcessStartError(
        f"the process for MeshLab {how}: check the installation, the memory, and the limits on "
        "processes and open files"
    )


def as_text(content: object) -> str:
    """Pickle an object for a line."""
    return base64.b64encode(pickle.dumps(content)).decode()


def from_text(text: str) -> Any:
    """Return what `as_text` has pickled."""
    return pickle.loads(base64.b64decode(text))
