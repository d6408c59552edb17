"""A run in tiles: planned, begun or gone on with, and written whole or not at all."""

from __future__ import annotations

import contextlib
import math
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.errors import MeshFileError, OptionError, UntiledError
from meshlab_spectral.files.extensions import is_same_format
from meshlab_spectral.files.region_vertices import NOTHING_SELECTED
from meshlab_spectral.files.sources import check_is_place, check_source
from meshlab_spectral.files.whole_files import LOCK, check_target, holding, resolved, writing_whole
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import DenoiseOptions, FilterOptions
from meshlab_spectral.filters.progress import StageCallback
from meshlab_spectral.formats.digits import rounding_message, widening_warnings
from meshlab_spectral.formats.opening import open_rows
from meshlab_spectral.formats.rows import MeshRows
from meshlab_spectral.plugin.limits import memory_remedy
from meshlab_spectral.plugin.versions import versions
from meshlab_spectral.tiles import MOST_TILES
from meshlab_spectral.tiles.cells import near_cells, split
from meshlab_spectral.tiles.exchange import gather, scatter
from meshlab_spectral.tiles.halo import reach_of, require_local
from meshlab_spectral.tiles.noise import given_noise, measured_noise
from meshlab_spectral.tiles.plan import Plan, Workspace
from meshlab_spectral.tiles.report import combined, mean_share
from meshlab_spectral.tiles.survey import Survey, survey
from meshlab_spectral.tiles.tile_jobs import TileJob, check_seen, run_tile
from meshlab_spectral.warned import Warned, warned, with_warnings
from meshlab_spectral.workers.memory import PROCESS_BYTES, TILE_BYTES, limit_for, workers_for_tiles
from meshlab_spectral.workers.opening import open_workers
from meshlab_spectral.workers.pool import Workers

# Larger tiles are hardly faster, and a failed or interrupted one costs more.
_LARGEST_TILE = 1_000_000  # vertices
# A tile whose halo is this many times its cell is none.
_MOST_WORK = 30.0
# Tiles, at most, that find out how many passes the mesh needs.
_ASKED = 5
# As the core does for a whole mesh: it repeats until the tolerance is reached on all but this share
# of the surface, or in so many passes (automatic_steps.h).
_NEGLIGIBLE, _MOST_PASSES = 1e-3, 7
# The core keeps thin parts as soon as one has a larger factor (thin_parts.h).
_WORTHWHILE = 2.0

# Filters certain tiles by what was decided, unless they are; returns their reports.
_Doing = Callable[[dict[str, Any]], list[dict[str, Any]]]
_Pool = Workers[TileJob, tuple[int, dict[str, Any]]]


def filter_in_tiles(
    source: Path,
    target: Path,
    options: Options,
    on_progress: StageCallback,
    tiles: int,
    tell: Callable[[str], None],
    overwrite: bool = True,
    scheduler: str | None = None,
) -> dict[str, Any]:
    """Filter a binary PLY or STL file in tiles, in a folder next to the output.

    The folder is removed at the end. After an error it stays if all faces have been handed to the
    tiles: the same call then goes on from it.
    With the address of a Dask scheduler its workers do the tiles; they must see folder and source.
    """
    _check_files(source, target)
    require_local(options)
    path = resolved(target)
    work = Workspace(path.with_name(f".{path.name}.tiles"))
    rows = open_rows(source)
    with _workers(scheduler) as pool, holding(work.folder), work.removed_if_not_begun():
        pool.on_each(partial(check_seen, str(source.absolute()), str(work.folder)))
        plan = _planned(rows, source, options, on_progress, tiles, work, pool)
        why = f" by the workers at {scheduler}" if scheduler else ""
        if not tiles and not scheduler:
            why = ", as it does not fit in memory as a whole"
        tell(f"{source.name} is processed in {plan.tiles} tiles{why}")
        try:
            reports = _filtered(plan, work, on_progress, pool)
            report, is_wide = _summary(plan, reports, rows)
            with writing_whole(target, overwrite) as scratch:
                gather(rows, work, plan.tiles, scratch, is_wide, on_progress)
        except OSError as error:
            raise MeshFileError(
                f"{work.folder} cannot be written ({error.strerror}): make room, and run the same "
                "command again, which goes on from there",
                "disk_full",
            ) from error
    shutil.rmtree(work.folder, ignore_errors=True)
    return report


def intent_in_tiles(
    source: Path,
    target: Path,
    options: Options,
    on_progress: StageCallback,
    tiles: int,
    scheduler: str | None = None,
) -> dict[str, Any]:
    """Say what `filter_in_tiles` would do; see `whole_or_tiles.intent_of_file`."""
    _check_files(source, target)
    require_local(options)
    rows = open_rows(source)
    measured = _surveyed(rows, options, on_progress)
    diagonal, edge, _ = measured.lengths
    with _workers(scheduler) as pool:
        reach = reach_of(options, measured.lengths)
        _, count, _ = _divided(rows, measured, reach, tiles, pool)
    surface = {
        "mesh": "",
        "vertices": rows.vertices,
        "faces": rows.faces,
        "diagonal": diagonal,
        "mean_edge": edge,
        "sizes": options.sizes(*measured.lengths),
    }
    return {"surfaces": [surface], "is_patched": True, "tiles": count}


def _check_files(source: Path, target: Path) -> None:
    """Raise SpectralError unless tiles of one file can become the other."""
    check_source(source)
    check_is_place(target)
    if not is_same_format(source, target):
        raise UntiledError(
            f"tiles are written in the format of the input: name a {source.suffix} file"
        )
    check_target(target)


def _planned(
    rows: MeshRows,
    source: Path,
    options: Options,
    on_progress: StageCallback,
    tiles: int,
    work: Workspace,
    pool: _Pool,
) -> Plan:
    """Return the plan of a run, whose faces have been handed to the tiles, now or before."""
    stat = source.stat()
    stamp = [stat.st_size, stat.st_mtime_ns]
    with contextlib.suppress(OSError, ValueError, TypeError):
        old = work.plan()
        is_same = (old.source, old.stamp) == (str(source.absolute()), stamp)
        is_same = is_same and (old.filter, old.options) == (options.TABLE, options.as_dict())
        is_same = is_same and old.versions == versions()
        if is_same and tiles in (0, old.tiles) and work.has_begun(old):
            return old
    measured = _surveyed(rows, options, on_progress)
    reach = reach_of(options, measured.lengths)
    tree, count, grown = _divided(rows, measured, reach, tiles, pool)
    _clear(work.folder)
    plan = Plan(
        str(source.absolute()),
        stamp,
        options.TABLE,
        options.as_dict(),
        list(measured.lengths[:3]),
        bool(options.as_dict()["selected"]),
        tree,
        count,
        reach,
        versions(),
    )
    _require_space(rows, work.folder, grown)
    work.begin(plan)
    try:
        scatter(rows, plan, work, on_progress)
    except OSError as error:
        _clear(work.folder)  # nothing of it is of use
        raise MeshFileError(
            f"{work.folder} cannot be written ({error.strerror}): make room on the disk",
            "disk_full",
        ) from error
    return plan


def _surveyed(rows: MeshRows, options: Options, on_progress: StageCallback) -> Survey:
    """Survey a mesh; raise OptionError where nothing is selected of what was asked for."""
    measured = survey(rows, on_progress)
    if options.as_dict()["selected"] and not measured.has_selection:
        raise OptionError(NOTHING_SELECTED)
    return measured


def _clear(folder: Path) -> None:
    for path in folder.iterdir():
        if path.name != LOCK:
            path.unlink()


def _divided(
    rows: MeshRows, measured: Survey, reach: float, tiles: int, pool: _Pool
) -> tuple[Any, int, float]:
    """Return cells, their number, and how many times the mesh all tiles are together.

    Raises UntiledError when tiles with all that they need do not fit in the memory of a worker.
    """
    vertices, memory = rows.vertices, pool.memory
    largest = math.inf if memory is None else max(0, memory - PROCESS_BYTES) / TILE_BYTES
    sample, least = measured.sample, math.inf
    count = tiles or max(2, math.ceil(vertices / _LARGEST_TILE))
    while True:
        tree = split(sample, count)
        held = [len(near) for _, near in near_cells(tree, sample, sample, reach)]
        share, total = max(held) / len(sample), sum(held) / len(sample)
        if share * vertices <= largest:
            return tree, count, total
        least = min(least, share * vertices)
        if tiles or count > MOST_TILES or total > _MOST_WORK:
            raise _too_large(reach, least, pool, bool(tiles))
        count = math.ceil(1.4 * count)


def _too_large(reach: float, vertices: float, pool: _Pool, has_number: bool) -> UntiledError:
    """Return the error for tiles of so many vertices, at least, that do not fit in a worker."""
    needed, memory = math.ceil(PROCESS_BYTES + TILE_BYTES * vertices), pool.memory or 0
    more = f"give the workers {needed / 2**20:.0f} MiB each"
    remedies = [more if pool.on_cluster else memory_remedy(limit_for(needed))]
    if memory > PROCESS_BYTES:  # else no tile fits, however small
        remedies += ["choose more tiles"] * has_number + ["choose a smaller feature_size"]
    return UntiledError(
        f"the filter reaches {reach:.3g} far, and tiles with that around them have {vertices:.3g} "
        f"vertices or more, which take {needed / 2**20:.0f} MiB, while a worker has "
        f"{memory / 2**20:.0f} MiB: {', or '.join(remedies)}"
    )


def _require_space(rows: MeshRows, folder: Path, times: float) -> None:
    """Raise MeshFileError unless what tiles write has room, with the output."""
    each = 4 + 24 + (24 if "normals" in rows.kinds else 0)
    needed = 1.1 * times * 12 * rows.faces + each * rows.points + 1.3 * rows.path.stat().st_size
    free = shutil.disk_usage(folder).free
    if needed > free:
        raise MeshFileError(
            f"{folder.parent} needs {needed / 1e9:.2g} GB of free space for tiles, and has "
            f"{free / 1e9:.2g} GB: make room on the disk, or write the output elsewhere",
            "disk_full",
        )


def _workers(scheduler: str | None) -> contextlib.AbstractContextManager[_Pool]:
    count, memory = workers_for_tiles() if scheduler is None else (None, None)
    return open_workers(run_tile, scheduler, count, memory)


def _filtered(
    plan: Plan, work: Workspace, on_progress: StageCallback, pool: _Pool
) -> list[dict[str, Any]]:
    """Filter all tiles that are not done yet; return the reports of all."""
    options = plan.options_of_filter()
    every = range(plan.tiles)
    asked = [int(t) for t in np.unique(np.linspace(0, plan.tiles - 1, _ASKED).round())]

    def do(tiles: Any, wanted: dict[str, Any], upto: float = 1.0) -> list[dict[str, Any]]:
        reports = {tile: work.report(tile) for tile in tiles}
        left = [tile for tile in tiles if not _is_done(reports[tile], wanted)]
        source_and_folder = plan.source, str(work.folder)
        jobs = [TileJob(*source_and_folder, tile, plan.tiles, wanted) for tile in left]
        with contextlib.closing(pool.run(jobs)) as results:
            for done, (tile, report) in enumerate(results, 1):
                reports[tile] = report
                name = f"tile {plan.tiles - len(left) + done}"
                on_progress(name, upto * done / len(left))
        return [report or {} for report in reports.values()]

    do_asked = partial(do, asked, upto=len(asked) / plan.tiles)
    if isinstance(options, DenoiseOptions):
        return _denoised(plan, options, do_asked, partial(do, every))
    assert isinstance(options, FilterOptions)
    decided = {"passes": options.passes, "has_thin_parts": False}
    if options.steps == 0 and options.passes == 0 and options.basis_update != "none":
        while decided["passes"] < _MOST_PASSES:
            decided["passes"] += 1
            reports = do_asked(decided)
            if not decided["has_thin_parts"] and _has_thin_parts(reports):
                decided["has_thin_parts"] = True  # else what must stay would ask for more passes
                reports = do_asked(decided)
            # The share of the surface on which the tolerance is not reached.
            if mean_share("singular_part", reports) <= _NEGLIGIBLE:
                break
    reports = do(every, decided)
    if not decided["has_thin_parts"] and _has_thin_parts(reports):
        decided["has_thin_parts"] = True
        reports = do(every, decided)
    return reports


def _denoised(
    plan: Plan, options: DenoiseOptions, do_asked: _Doing, do_every: _Doing
) -> list[dict[str, Any]]:
    """Denoise all tiles by the noise of some; return the reports of all."""
    noise = given_noise(options, *plan.lengths[:2])
    if not all(noise.values()):
        noise = measured_noise(do_asked(noise), options, plan.lengths[1])
    reports = do_every(noise)
    if not any(noise.values()):  # every tile has looked for noise
        noise = measured_noise(reports, options, plan.lengths[1])
        if any(noise.values()):
            reports = do_every(noise)
    if options.noise_height.automatic:
        for one in reports:
            if "summary" in one:
                one["summary"] = one["summary"].replace(", as given", ", as measured in tiles")
    return reports


def _has_thin_parts(reports: list[dict[str, Any]]) -> bool:
    return any(one.get("thin_part_factor", 1) > _WORTHWHILE for one in reports)


def _is_done(report: dict[str, Any] | None, wanted: dict[str, Any]) -> bool:
    """Whether a tile has been filtered by these decisions, or any would do."""
    if report is None:
        return False
    is_same = all(report.get(f"wanted_{name}") == value for name, value in wanted.items())
    return is_same or not report["ran"]  # nothing of it moves


def _summary(
    plan: Plan, reports: list[dict[str, Any]], rows: MeshRows
) -> tuple[dict[str, Any], bool]:
    """Return the report of the whole, and whether coordinates need double precision."""
    report, (rounding, displacement, largest) = combined(plan.filter, reports)
    report = {"tiles": plan.tiles, **report}
    told = rounding_message(rounding, displacement, largest) if rows.is_single else None
    if told and rows.is_joined_by_position:
        remedy = f"{told}: choose .ply, or move the mesh to the origin first"
        return with_warnings(report, [*warned(report), Warned("rounded", remedy)]), False
    return with_warnings(report, warned(report) + widening_warnings(told)), bool(told)
