"""Filtering, measuring and comparing files in a child process, one per call.

The calling command can thus be interrupted, show progress, and report even a crash of MeshLab.
"""

from __future__ import annotations

import pickle
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshlab_spectral.files.request import Request
from meshlab_spectral.files.sources import check_is_place, check_source
from meshlab_spectral.files.whole_files import (
    remove_leftovers,
    resolved,
    temporary_folder,
    writing_whole,
)
from meshlab_spectral.filters.progress import StageCallback
from meshlab_spectral.workers.process import NO_LIMITS, JobLimits, process_for_job

if TYPE_CHECKING:
    from meshlab_spectral.files.comparison import Comparison
    from meshlab_spectral.filters.texture import SurfaceTexture


def write_in_child(
    call: str,
    request: Request,
    target: Path,
    on_progress: StageCallback,
    overwrite: bool = True,
    limits: JobLimits = NO_LIMITS,
) -> dict[str, Any]:
    """Let a function of the `child`, such as `filter_to_scratch`, write a file.

    The file is written atomically, and replaces an existing one if it may. `on_progress`, `limits`
    and errors are those of `MeshLabProcess.run`. KeyboardInterrupt passes after the child has been
    ended and the scratch files removed.
    """
    check_source(request.source)
    check_is_place(target)
    remove_leftovers(resolved(target).parent, target.name)
    with writing_whole(target, overwrite) as scratch:
        return measure_in_child(call, request, on_progress, limits, scratch=scratch.absolute())


def measure_in_child(
    call: str,
    request: Request,
    on_progress: StageCallback,
    limits: JobLimits = NO_LIMITS,
    **more: Path,
) -> dict[str, Any]:
    """Let a function of the `child`, such as `mesh_info`, measure a file; `more` are its arguments.

    Other parameters and errors are those of `write_in_child`.
    """
    check_source(request.source)
    request = replace(request, source=request.source.absolute())
    with process_for_job() as process:
        job = {"call": call, "request": request, **more}
        return process.run(job, on_progress, limits).report


def compare_in_child(
    a: Path,
    b: Path,
    on_progress: StageCallback,
    whole: bool,
    max_distance: float | None = None,
) -> Comparison:
    """Compare two mesh files in a child process, as `comparison_of` does."""
    check_source(a)
    check_source(b)
    job = {"a": a.absolute(), "b": b.absolute(), "max_distance": max_distance, "whole": whole}
    found: Comparison = _result_of({"call": "comparison_of", **job}, on_progress)
    return found


def texture_in_child(
    request: Request, on_progress: StageCallback
) -> tuple[Any, Any, SurfaceTexture]:
    """Measure the texture of a mesh file in a child process, as `texture_of` does."""
    check_source(request.source)
    request = replace(request, source=request.source.absolute())
    job = {"call": "texture_of", "request": request}
    found: tuple[Any, Any, SurfaceTexture] = _result_of(job, on_progress)
    return found


def _result_of(job: dict[str, Any], on_progress: StageCallback) -> Any:
    """Do a job in a child process; return its result, which comes in a file for its arrays."""
    with temporary_folder(Path(tempfile.gettempdir())) as folder:
        result = folder / "result"
        with process_for_job() as process:
            process.run({**job, "result": result}, on_progress)
        return pickle.loads(result.read_bytes())
