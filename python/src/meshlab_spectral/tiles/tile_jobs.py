"""A tile as a job for a worker, of this machine or of a cluster that sees the same files."""

from __future__ import annotations

import os
import socket
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from meshlab_spectral.errors import FilterError, MeshFileError
from meshlab_spectral.workers.processes import Processes


@dataclass(frozen=True)
class TileJob:
    """Everything a worker needs to filter one tile, as plain values; the rest is in files."""

    source: str
    folder: str
    tile: int
    tiles: int  # of the run
    decided: dict[str, Any] = field(hash=False)  # see `tiles.tile.filter_tile`

    def failed(self, reason: str, attempts: int) -> NoReturn:
        """Raise the error of a tile that no worker could do."""
        raise self.named(FilterError(reason))

    def named(self, error: FilterError) -> FilterError:
        """Return an error of the tile with its number, and what is left."""
        named = type(error)(
            f"tile {self.tile + 1} of {self.tiles}: {error}. The tiles that are done stay in "
            f"{self.folder}, from which the same command goes on"
        )
        named.code, named.limit = error.code, error.limit
        return named


def check_seen(*paths: str) -> None:
    """Raise MeshFileError unless this machine sees files and folders of a run."""
    for path in paths:
        if not os.access(path, os.R_OK):
            raise MeshFileError(
                f"the worker on {socket.gethostname()} does not see {path}: keep input and output "
                "in folders that all workers share, under the same paths"
            )


def run_tile(processes: Processes, job: TileJob) -> tuple[int, dict[str, Any]]:
    """Filter a tile, and return its number and report; its other results are files.

    Raises SpectralError, and ProcessesEndedError when the processes are ended meanwhile.
    """
    check_seen(job.source, job.folder)
    work = {"folder": Path(job.folder), "tile": job.tile, "decided": job.decided}
    try:
        answer = processes.run({"call": "filter_tile", **work})
    except FilterError as error:
        raise job.named(error) from error
    return job.tile, answer.report
