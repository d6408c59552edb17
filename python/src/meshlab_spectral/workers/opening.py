"""Opening workers on this machine, or those of a Dask cluster."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from meshlab_spectral.errors import BatchError
from meshlab_spectral.files.whole_files import temporary_folder
from meshlab_spectral.workers.memory import machine_memory, processors
from meshlab_spectral.workers.pool import JobT, ResultT, Workers
from meshlab_spectral.workers.process import JobLimits
from meshlab_spectral.workers.processes import Processes

# Fraction of the machine's memory that all workers share.
_SHARE_OF_MEMORY = 0.9
# While MeshLab filters one mesh, the files of another are copied and hashed.
_JOBS_PER_WORKER = 2


@contextlib.contextmanager
def open_workers(
    do: Callable[[Processes, JobT], ResultT],
    scheduler: str | None = None,
    count: int | None = None,
    memory_limit: int | None = None,
) -> Iterator[Workers[JobT, ResultT]]:
    """Yield workers, which `do` jobs by their processes.

    With the address of its `scheduler`, they are those of a Dask cluster; see `cluster`. Otherwise
    each of `count` processes, by default one per processor, does one job at a time, with its share
    of the threads. `memory_limit` is in bytes per process; by default they share nine tenths of the
    machine's memory, and keep to the limit of the environment, if any.
    """
    if scheduler is not None:
        from meshlab_spectral.workers.cluster import workers_at  # a package of an extra

        with workers_at(scheduler, do) as workers:
            yield workers
        return
    count = count or processors()
    share = int(_SHARE_OF_MEMORY * machine_memory() / count)
    limits = JobLimits(memory_limit or share, replaces_environment=memory_limit is not None)
    with contextlib.ExitStack() as stack:
        try:
            folder = stack.enter_context(temporary_folder(Path(tempfile.gettempdir())))
        except OSError as error:
            raise BatchError(f"no temporary folder can be made ({error}): set TMPDIR") from error
        processes = Processes(count, limits, folder)
        stack.callback(processes.end)
        yield Workers(
            partial(do, processes),
            _JOBS_PER_WORKER * count,
            processes.end,
            limits.memory,
            lambda function: function(),
        )
