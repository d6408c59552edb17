"""Running jobs, such as files of a batch, each in a thread that waits for a worker."""

from __future__ import annotations

import atexit
import contextlib
import queue
import threading
import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

JobT = TypeVar("JobT")
ResultT = TypeVar("ResultT")

# On Windows, a program that waits for longer does not notice Ctrl-C.
_SECONDS_TO_WAIT = 0.2
# After an interruption, for moving finished outputs into place.
_SECONDS_TO_END = 5


@dataclass(frozen=True)
class Workers(Generic[JobT, ResultT]):
    """What does the jobs: processes on this machine, or the workers of a cluster."""

    do: Callable[[JobT], ResultT]  # in the calling thread
    at_once: int  # threads that should call it
    end: Callable[[], None]  # makes all calls end soon, whatever they are doing
    memory: int | None  # bytes that every job may take; None: not limited
    on_each: Callable[[Callable[[], object]], object]  # calls a function on each machine
    on_cluster: bool = False

    def run(
        self, jobs: Sequence[JobT], record: Callable[[ResultT], object] = lambda _: None
    ) -> Generator[ResultT, None, None]:
        """Run jobs, begun in this order, and yield the result of each as soon as it is done.

        `record` gets it first, even if the caller is still busy with another one, or ends the
        iteration meanwhile; several threads call it. Raises what `record` or a worker has raised;
        the workers end then, and when the iteration ends early.
        """
        waiting: queue.SimpleQueue[JobT] = queue.SimpleQueue()
        results: queue.SimpleQueue[ResultT | BaseException] = queue.SimpleQueue()
        for job in jobs:
            waiting.put(job)

        def work() -> None:
            try:
                with contextlib.suppress(queue.Empty):
                    while True:
                        result = self.do(waiting.get_nowait())
                        record(result)
                        results.put(result)
            except BaseException as error:
                results.put(error)

        def stop() -> None:
            self.end()
            end = time.monotonic() + _SECONDS_TO_END
            for thread in threads:
                thread.join(max(0.0, end - time.monotonic()))

        threads: list[threading.Thread] = []
        atexit.register(stop)  # at the end of a program that has not ended the iteration
        try:
            for _ in range(min(len(jobs), self.at_once)):
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
        except BaseException:
            stop()
            raise
        finally:
            atexit.unregister(stop)
