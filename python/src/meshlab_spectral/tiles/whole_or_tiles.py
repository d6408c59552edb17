"""Whether a file is filtered as a whole or in tiles."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from meshlab_spectral.errors import MemoryLimitError, MeshFileError, OptionError, UntiledError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.sources import check_source
from meshlab_spectral.files.whole_files import check_target
from meshlab_spectral.filters.progress import StageCallback
from meshlab_spectral.workers.process import NO_LIMITS, JobLimits
from meshlab_spectral.workers.single_file import measure_in_child, write_in_child

# Smaller files are tried as a whole, without a look at them.
_SMALL = 32 * 2**20
# Memory that filtering a whole file takes for each vertex, from reading to writing; measured, about
# 1,500 (tests/benchmarks/bench_tiles.py).
_SURELY, _USUALLY, _MOST = 1000, 1500, 2000


def filter_file(
    request: Request,
    target: Path,
    on_progress: StageCallback,
    overwrite: bool,
    tiles: int | None,
    tell: Callable[[str], None],
    scheduler: str | None = None,
) -> dict[str, Any]:
    """Filter a file as `write_in_child` does; in tiles where that is refused for lack of memory.

    `tiles` is how many; 0 for as many as it takes, if it takes any; None for none. `tell` is called
    with a line that says why there are tiles. With a Dask `scheduler`, its cluster filters in
    tiles, whether or not the whole fits in memory. Raises SpectralError as `write_in_child` does;
    UntiledError when a number of tiles is given for what cannot be divided.
    """
    tiles = _tiles_for(request, tiles, scheduler)
    if tiles is None:
        return write_in_child("filter_to_scratch", request, target, on_progress, overwrite)

    def in_tiles(number: int) -> dict[str, Any]:
        from meshlab_spectral.tiles.run import filter_in_tiles  # a slow import

        what = request.source, target, request.options
        return filter_in_tiles(*what, on_progress, number, tell, overwrite, scheduler)

    if tiles > 0 or scheduler is not None:
        return in_tiles(tiles)
    try:
        limits = _limits(request.source)
        return write_in_child("filter_to_scratch", request, target, on_progress, overwrite, limits)
    except MemoryLimitError as refusal:
        try:
            return in_tiles(0)
        except UntiledError as error:
            raise MemoryLimitError(f"{refusal}; nor can it be filtered in tiles: {error}") from None


def intent_of_file(
    request: Request,
    target: Path,
    on_progress: StageCallback,
    tiles: int | None,
    scheduler: str | None = None,
) -> dict[str, Any]:
    """Say what `filter_file` would do, and write nothing.

    Returns what `files.intent_of` does, and "tiles", their number, 0 for none; "memory", about what
    the whole takes, and "available_memory", bytes. Raises SpectralError as `filter_file` does, as
    far as can be told from the file and the options.
    """
    check_source(request.source)
    check_target(target)
    tiles = _tiles_for(request, tiles, scheduler)
    if tiles == 0 and scheduler is None:
        with contextlib.suppress(MemoryLimitError):
            _limits(request.source)
            tiles = None
    if tiles is None:
        intent = measure_in_child("intent_of", request, on_progress, target=target.absolute())
        intent["tiles"] = 0
    else:
        from meshlab_spectral.tiles.run import intent_in_tiles

        what = request.source, target, request.options
        intent = intent_in_tiles(*what, on_progress, tiles, scheduler)
    from meshlab_spectral.workers.memory import available_memory

    vertices = sum(one["vertices"] for one in intent["surfaces"])
    return {**intent, "memory": _USUALLY * vertices, "available_memory": available_memory()}


def _tiles_for(request: Request, tiles: int | None, scheduler: str | None) -> int | None:
    """Return the number of tiles, 0 for as many as it takes, None where there are none.

    Raises UntiledError when a number, or a scheduler, is given for what cannot be divided.
    """
    asking = "tiles" if tiles else "the scheduler"
    parts = [*request.region.given(), *["mesh"] * bool(request.mesh)]
    if parts and (tiles or scheduler is not None):
        names = ", ".join(parts)
        raise UntiledError(f"only the whole is filtered in tiles: leave out {names}, or {asking}")
    if scheduler is not None and tiles is None:
        raise OptionError("a cluster filters in tiles: leave out tiles = off, or the scheduler")
    if scheduler is not None:
        check_extras("cluster")
    return None if parts else tiles


def _limits(source: Path) -> JobLimits:
    """Return the limits for a whole file; raise MemoryLimitError if it surely is too large."""
    check_source(source)
    if source.stat().st_size < _SMALL:
        return NO_LIMITS
    from meshlab_spectral.formats.opening import open_rows
    from meshlab_spectral.workers.memory import available_memory

    try:
        vertices = open_rows(source).vertices
    except MeshFileError:
        return NO_LIMITS
    available = available_memory()
    if _SURELY * vertices > available:
        raise MemoryLimitError(
            f"{source.name} needs more than {available / 2**20:.0f} MiB of memory"
        )
    # Before the system ends the process, for want of any memory.
    return JobLimits(memory=available) if _MOST * vertices > available else NO_LIMITS
