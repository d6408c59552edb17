"""Workers on a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import threading
import uuid
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from distributed import (
    CancelledError,
    Client,
    Event,
    KilledWorker,
    Reschedule,
    WorkerPlugin,
    get_client,
    get_worker,
)
from distributed import TimeoutError as DaskTimeoutError  # in Python 3.10, not Python's own

from meshlab_spectral.errors import BatchError, SpectralError
from meshlab_spectral.plugin.limits import given_memory_limit
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.workers.pool import JobT, ResultT, Workers
from meshlab_spectral.workers.process import JobLimits
from meshlab_spectral.workers.processes import Processes, ProcessesEndedError

_SECONDS_TO_CONNECT = 10
_SECONDS_TO_CLOSE = 5
# Submitting all jobs at once would delay the start and take much of the scheduler's memory.
_SUBMITTED_PER_THREAD = 2
_FEWEST_SUBMITTED = 100  # for workers that join later


@contextlib.contextmanager
def workers_at(
    address: str, do: Callable[[Processes, JobT], ResultT]
) -> Iterator[Workers[JobT, ResultT]]:
    """Yield the workers of a running Dask cluster, which `do` jobs by their processes.

    `address` is the scheduler's, such as tcp://10.0.0.1:8786. Raises BatchError when it cannot be
    reached, has no workers, or has workers with other software versions.

    A job has a method `failed`, which is given a reason and the number of attempts, and returns, or
    raises, what comes of it when no worker can do it.
    """
    plugin = f"meshlab-spectral-{uuid.uuid4()}"  # other batches may use the cluster, too

    def unregister() -> None:
        with contextlib.suppress(OSError, DaskTimeoutError):  # the cluster is gone
            client.unregister_worker_plugin(plugin)

    with contextlib.ExitStack() as stack:
        for name in ("distributed", "distributed.client"):  # what matters is reported
            log = logging.getLogger(name)
            stack.callback(log.setLevel, log.level)
            log.setLevel(logging.CRITICAL)
        try:
            client = Client(address, timeout=_SECONDS_TO_CONNECT, set_as_default=False)
        except (OSError, ValueError, DaskTimeoutError) as error:
            raise BatchError(
                f"no Dask scheduler can be reached at {address} ({error}): check the address and "
                "that `dask scheduler` is running there"
            ) from error
        ending = stack.enter_context(contextlib.ExitStack())  # once, by whoever is first
        ending.callback(client.close, timeout=_SECONDS_TO_CLOSE)
        _check_workers(client, address)
        client.register_plugin(_Processes(), plugin)
        ending.callback(unregister)
        threads = sum(client.nthreads().values())
        at_once = max(_FEWEST_SUBMITTED, _SUBMITTED_PER_THREAD * threads)
        memory = min(filter(None, client.run(_memory).values()), default=None)
        turns = _Turns()
        yield Workers(
            partial(_submit, client, plugin, turns, do),
            at_once,
            ending.close,
            memory,
            client.run,
            on_cluster=True,
        )


class _Turns:
    """Lets jobs run together, or one alone once no other is running."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._running = 0
        self._is_one_alone = False

    @contextlib.contextmanager
    def taken(self, is_alone: bool) -> Iterator[None]:
        """Take part in what runs together, or run alone."""
        with self._changed:
            self._changed.wait_for(lambda: not (self._is_one_alone or (is_alone and self._running)))
            self._running += 1
            self._is_one_alone = is_alone
        try:
            yield
        finally:
            with self._changed:
                self._running -= 1
                self._is_one_alone = False
                self._changed.notify_all()


def _submit(
    client: Client, plugin: str, turns: _Turns, do: Callable[[Processes, Any], Any], job: Any
) -> Any:
    """Let a worker do a job.

    If the worker dies, Dask gives all jobs that it had to others, up to three times: those merely
    queued there, too. After that each of them gets one more try, alone. The death of a MeshLab
    process is handled by the worker, see `Processes.run`.
    """
    attempts = 0
    for run, is_alone in ((_run, False), (partial(_run_once, uuid.uuid4().hex, _run), True)):
        try:
            with turns.taken(is_alone):
                return client.submit(run, plugin, do, job, pure=False).result()
        except KilledWorker as error:
            attempts = attempts or error.allowed_failures + 1
        except _TriedError:
            pass
        except Exception as error:
            return _instead(error, job)
    return job.failed(
        f"{attempts} workers that had it were ended from outside, and one that did nothing else: "
        "if memory is short there, give the workers more, or filter it by itself",
        attempts + 1,
    )


def _instead(error: Exception, job: Any) -> Any:
    """Raise what stops the run, and return the result of a job that alone has failed."""
    if isinstance(error, SpectralError):
        raise error
    if isinstance(error, OSError | CancelledError | DaskTimeoutError):
        raise BatchError(
            "the Dask cluster is gone: restart it, then run the same command again, a batch with "
            "--resume"
        ) from error
    return job.failed(f"unexpected error: {error!r}; please report it", 0)


class _TriedError(Exception):
    """A worker has ended in the only try of a job."""


def _run_once(
    token: str,
    run: Callable[[str, Callable[[Processes, JobT], ResultT], JobT], ResultT],
    plugin: str,
    do: Callable[[Processes, JobT], ResultT],
    job: JobT,
) -> ResultT:
    """Run a job, unless a worker has begun it: Dask would try it three times more."""
    begun = Event(token, client=get_client())
    if begun.is_set():
        raise _TriedError
    begun.set()
    return run(plugin, do, job)


def _run(plugin: str, do: Callable[[Processes, JobT], ResultT], job: JobT) -> ResultT:
    """Run a job, in a thread of a worker."""
    try:
        return do(get_worker().plugins[plugin].processes, job)
    except ProcessesEndedError:
        raise Reschedule from None  # the worker is closing


class _Processes(WorkerPlugin):  # type: ignore[misc]
    """The MeshLab processes of a worker, for one run."""

    def setup(self, worker: Any) -> None:
        limits = JobLimits(_share(worker))
        self.processes = Processes(worker.state.nthreads, limits, Path(worker.local_directory))

    def teardown(self, worker: Any) -> None:
        self.processes.end()


def _share(worker: Any) -> int | None:
    memory = worker.memory_manager.memory_limit
    return int(memory / worker.state.nthreads) if memory else None


def _memory(dask_worker: Any) -> int | None:  # Dask knows the name
    return min(filter(None, (_share(dask_worker), given_memory_limit())), default=None)


def _check_workers(client: Client, address: str) -> None:
    try:
        client.wait_for_workers(1, timeout=_SECONDS_TO_CONNECT)
    except DaskTimeoutError:
        raise BatchError(
            f"the Dask scheduler at {address} has no workers: start some with `dask worker "
            f"{address}`"
        ) from None
    try:
        found: dict[str, Any] = client.run(versions)
    except ModuleNotFoundError as error:
        raise BatchError(
            f"the workers at {address} cannot import {error.name}: install this package there"
        ) from error
    here = versions()
    for worker, there in found.items():
        different = [
            f"{name} {there.get(name, '')[:12]} instead of {here[name][:12]}"
            for name in here
            if name != "python" and there.get(name) != here[name]
        ]
        if different:
            raise BatchError(
                f"the worker {worker} has different software from this machine: "
                f"{', '.join(different)}; install the same versions on both"
            )
