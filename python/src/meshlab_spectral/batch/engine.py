"""Running the jobs of a batch, each in a thread that waits for a worker."""

from __future__ import annotations

import atexit
import contextlib
import queue
import threading
import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass

from meshlab_spectral.batch.jobs import FileResult, Job

# On Windows, a program that waits for longer does not notice Ctrl-C.
_SECONDS_TO_WAIT = 0.2
# After an interruption, for moving finished outputs into place.
_SECONDS_TO_END = 5


@dataclass(frozen=True)
class Workers:
    """What does the jobs: processes on this machine, or the workers of a cluster."""

    do: Callable[[Job], FileResult]  # in the calling thread
    at_once: int  # threads that should call it
    end: Callable[[], None]  # makes all calls end soon, whatever they are doing
    # Does several jobs together, unless it is a cluster.
    do_joined: Callable[[Sequence[Job]], list[FileResult]] | None = None


def run_jobs(
    workers: Workers, jobs: Sequence[Job], record: Callable[[FileResult], None]
) -> Generator[FileResult, None, None]:
    """Run jobs, begun in this order, and yield the result of each as soon as it is done.

    `record` gets it first, even if the caller is still busy with another one, or ends the iteration
    meanwhile; several threads call it. Raises what `record` or a worker has raised.
    """
    waiting: queue.SimpleQueue[Job] = queue.SimpleQueue()
    results: queue.SimpleQueue[FileResult | BaseException] = queue.SimpleQueue()
    for job in jobs:
        waiting.put(job)

    def work() -> None:
        try:
            with contextlib.suppress(queue.Empty):
                while True:
                    result = workers.do(waiting.get_nowait())
                    record(result)
                    results.put(result)
        except BaseException as error:
            results.put(error)

    def stop() -> None:
        workers.end()
        end = time.monotonic() + _SECONDS_TO_END
        for thread in threads:
            thread.join(max(0.0, end - time.monotonic()))

    threads: list[threading.Thread] = []
    atexit.register(stop)  # at the end of a program that has not ended the iteration
    try:
        for _ in range(min(len(jobs), workers.at_once)):
            thread = threading.Thread(target=work, daemon=True)
            thread.start()
            threads.append(thread)
        for _ in jobs:
            result = None
            while result is None:
                with contextlib.suppress(queue.Empty):
                    result = results.get(timeout=_SECONDS_TO_WAIT)
            if isinstance(result, BaseException):
                raise result
            yield result
    finally:
        stop()
        atexit.unregister(stop)
