"""Filtering, measuring and comparing files in a child process, one per call.

The calling command can thus be interrupted, show progress, and report even a crash of MeshLab.
"""

from __future__ import annotations

import pickle
import tempfile
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
from meshlab_spectral.workers.process import NO_LIMITS, JobLimits, ProgressCallback, process_for_job

if TYPE_CHECKING:
    from meshlab_spectral.files.comparison import Comparison
    from meshlab_spectral.filters.texture import SurfaceTexture


def write_in_child(
    request: Request,
    target: Path,
    on_progress: ProgressCallback,
    overwrite: bool = True,
    limits: JobLimits = NO_LIMITS,
) -> dict[str, Any]:
    """Filter a mesh file into another, or write its harmonics to an archive, in a child process.

    The file is written atomically, and replaces an existing one if it may. `on_progress` and
    `limits` are those of `MeshLabProcess.run`. Returns the filter's report; for harmonics, the
    numbers of "vertices" and "harmonics".

    Raises SpectralError when the source cannot be read, `target` cannot be written, the filter
    rejects the mesh or an option, or the child died without an answer. KeyboardInterrupt passes
    after the child has been ended and the scratch files removed.
    """
    check_source(request.source)
    check_is_place(target)
    remove_leftovers(resolved(target).parent, target.name)
    with writing_whole(target, overwrite) as scratch:
        return measure_in_child(request, on_progress, {"scratch": str(scratch.absolute())}, limits)


def measure_in_child(
    request: Request,
    on_progress: ProgressCallback,
    more: dict[str, Any] | None = None,
    limits: JobLimits = NO_LIMITS,
) -> dict[str, Any]:
    """Measure a mesh file in a child process: its spectrum or, without options, `mesh_info`.

    Parameters and errors are those of `write_in_child`; `more` extends the child's job.
    """
    check_source(request.source)
    with process_for_job() as process:
        return process.run({**request.as_job(), **(more or {})}, on_progress, limits).report


def compare_in_child(
    a: Path,
    b: Path,
    on_progress: ProgressCallback,
    whole: bool,
    max_distance: float | None = None,
) -> Comparison:
    """Compare two mesh files in a child process: `comparison.compare`, which says what is raised.

    Only the `whole` comparison has meshes, and values at their vertices.
    """
    check_source(a)
    check_source(b)
    job = {"task": "compare", "source": str(a.absolute()), "other": str(b.absolute())}
    more = {"max_distance": max_distance, "whole": whole}
    found: Comparison = _result_of({**job, **more}, on_progress)
    return found


def texture_in_child(
    request: Request, on_progress: ProgressCallback
) -> tuple[Any, Any, SurfaceTexture]:
    """Measure the texture of a mesh file in a child process, as `texture_of` does."""
    check_source(request.source)
    found: tuple[Any, Any, SurfaceTexture] = _result_of(request.as_job(), on_progress)
    return found


def _result_of(job: dict[str, Any], on_progress: ProgressCallback) -> Any:
    """Do a job in a child process; return its result, which comes in a file for its arrays."""
    with temporary_folder(Path(tempfile.gettempdir())) as folder:
        result = folder / "result"
        with process_for_job() as process:
            process.run({**job, "result": str(result)}, on_progress)
        return pickle.loads(result.read_bytes())
