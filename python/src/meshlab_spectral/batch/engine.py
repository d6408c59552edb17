"""Running jobs with Dask, on this machine or an existing cluster."""

from __future__ import annotations

import contextlib
import itertools
import logging
import signal
import sys
from collections.abc import Iterator, Sequence
from multiprocessing import resource_tracker
from typing import Any

import dask
import psutil
from dask.system import CPU_COUNT
from distributed import (
    CancelledError,
    Client,
    Future,
    KilledWorker,
    LocalCluster,
    WorkerPlugin,
    as_completed,
)
from distributed import TimeoutError as DaskTimeoutError  # in Python 3.10, not Python's own
from distributed.system import MEMORY_LIMIT

from meshlab_spectral.batch.jobs import FileResult, Job
from meshlab_spectral.batch.processes import processes
from meshlab_spectral.batch.task import run_job
from meshlab_spectral.errors import BatchError
from meshlab_spectral.plugin.limits import set_memory_limit, threads_each
from meshlab_spectral.plugin.versions import versions

# Fraction of the machine's memory that all workers share.
_SHARE_OF_MEMORY = 0.9
_SECONDS_TO_CONNECT = 10
_SECONDS_TO_CLOSE = 5
_FEWEST_SUBMITTED = 200
# While MeshLab filters one mesh, the worker copies and hashes the files of another.
_JOBS_PER_WORKER = 2
# Loggers whose levels Dask sets itself.
_LOGGERS = ("distributed", "distributed.client")
# Dask profiles itself for its dashboard a hundred times a second, which slows down small meshes on
# few processors.
_NO_STATISTICS = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.tick.cycle": "5s",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.admin.system-monitor.gil.enabled": False,
    "distributed.scheduler.active-memory-manager.start": False,
    "distributed.worker.memory.monitor-interval": "1s",
}


@contextlib.contextmanager
def local_workers(count: int | None = None, memory_limit: int | None = None) -> Iterator[Client]:
    """Start worker processes for `run_jobs`, reachable from this machine only.

    Each of the `count` workers, by default one per processor, filters one mesh at a time, with its
    share of the threads. `memory_limit` is in bytes per worker; by default they share nine tenths
    of the memory available to this process, and keep to the limit of the environment, if any. On
    exit they are killed, whatever they are doing. Raises BatchError when they fail to start.
    """
    count = count or CPU_COUNT
    limit = memory_limit or int(_SHARE_OF_MEMORY * MEMORY_LIMIT / count)
    with _quiet_log(), dask.config.set(_NO_STATISTICS), contextlib.ExitStack() as stack:
        with _interrupts_held_back():
            cluster = _start_cluster(count, limit)
            stack.callback(_close, cluster)
            client = Client(cluster, set_as_default=False)
            stack.callback(_close, client)
            stack.callback(_kill_workers, cluster)  # called first
            is_limited = memory_limit is not None
            client.register_plugin(_LocalWorker(threads_each(count), is_limited))
        yield client


@contextlib.contextmanager
def workers_at(address: str) -> Iterator[Client]:
    """Use the workers of a running Dask cluster.

    `address` is the scheduler's, such as tcp://10.0.0.1:8786. Raises BatchError when it cannot be
    reached, has no workers, or has workers with other software versions.
    """
    with _quiet_log():
        try:
            client = Client(address, timeout=_SECONDS_TO_CONNECT, set_as_default=False)
        except (OSError, ValueError, DaskTimeoutError) as error:
            raise BatchError(
                f"no Dask scheduler can be reached at {address} ({error}): check the address and "
                "that `dask scheduler` is running there"
            ) from error
        try:
            _check_workers(client, address)
            yield client
        finally:
            with contextlib.suppress(OSError, DaskTimeoutError):  # the cluster is gone
                client.run(_end_idle_processes, on_error="ignore")
            _close(client)


def run_jobs(client: Client, jobs: Sequence[Job]) -> Iterator[FileResult]:
    """Run jobs on workers, and yield the result of each as soon as it is done.

    If a worker dies, Dask gives its job to another one, up to three times. The death of a MeshLab
    process is handled by the worker, see `task`. Raises BatchError when the cluster is lost.
    """
    # Submitting all jobs at once would delay the start and take much of the scheduler's memory.
    window = max(_FEWEST_SUBMITTED, 4 * sum(client.nthreads().values()))
    waiting = iter(jobs)
    job_of: dict[Future, Job] = {}
    done = as_completed(loop=client.loop)

    def submit(count: int) -> None:
        chosen = list(itertools.islice(waiting, count))
        if chosen:
            futures = client.map(run_job, chosen, pure=False, key="filter")
            job_of.update(zip(futures, chosen, strict=True))
            done.update(futures)

    submit(window)
    for future in done:
        job = job_of.pop(future)
        try:
            if len(job_of) <= window // 2:
                submit(window // 2)
            failed = future.status == "error"
            result = _failed(job, future.exception()) if failed else future.result()
        except (OSError, CancelledError, DaskTimeoutError) as error:
            raise BatchError(
                "the Dask cluster is gone: restart it, then run the same command with --resume"
            ) from error
        yield result


def _failed(job: Job, error: BaseException) -> FileResult:
    attempts = 0
    if isinstance(error, KilledWorker):
        attempts = error.allowed_failures + 1
        reason = (
            "every worker that tried it was ended from outside: if memory is short, use fewer "
            "workers"
        )
    else:
        reason = f"unexpected error: {error!r}; please report it"
    return job.result("failed", reason=reason, attempts=attempts, versions=versions())


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


def _start_cluster(count: int, memory_limit: int) -> LocalCluster:
    try:
        return LocalCluster(
            n_workers=count,
            threads_per_worker=_JOBS_PER_WORKER,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            scheduler_kwargs={"dashboard": False},
            memory_limit=memory_limit,
            silence_logs=logging.CRITICAL,
        )
    except (OSError, RuntimeError) as error:
        raise BatchError(
            f"the worker processes do not start ({error}): check memory and the limit of open "
            'files. A script must call filter_files below `if __name__ == "__main__":`, because '
            "the workers import it, too"
        ) from error


@contextlib.contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Block Ctrl-C in processes started within this context, and defer it in this one.

    The terminal sends it to all its processes, but only this one handles it. Threads and workers
    started here inherit the signal mask, unless they start Python's resource tracker, which clears
    it. Windows has no signal masks: there, workers ignore Ctrl-C once they are set up.
    """
    if sys.platform == "win32":
        yield
        return
    resource_tracker.ensure_running()
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _kill_workers(cluster: LocalCluster) -> None:
    """Kill the workers; closing them would let them finish their current meshes."""
    for nanny in cluster.workers.values():
        nanny.close_gracefully()  # else it would restart the worker
        if nanny.pid is not None:
            with contextlib.suppress(psutil.Error):
                psutil.Process(nanny.pid).kill()


def _close(closable: Client | LocalCluster) -> None:
    with contextlib.suppress(OSError, DaskTimeoutError):
        closable.close(timeout=_SECONDS_TO_CLOSE)


def _end_idle_processes() -> None:
    """End the idle MeshLab processes; runs in a worker."""
    processes.end()


class _LocalWorker(WorkerPlugin):  # type: ignore[misc]
    """Sets up a worker of `local_workers`, or its replacement."""

    name = "meshlab-spectral"

    def __init__(self, threads: int, is_limited: bool) -> None:
        self.threads, self.is_limited = threads, is_limited

    def setup(self, worker: Any) -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        processes.limit(1)
        processes.threads = self.threads
        if self.is_limited:
            set_memory_limit(None)  # the limit given wins over that of the environment


@contextlib.contextmanager
def _quiet_log() -> Iterator[None]:
    """Silence Dask's log of starting and stopping workers; what matters is in the report."""
    loggers = [logging.getLogger(name) for name in _LOGGERS]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)
