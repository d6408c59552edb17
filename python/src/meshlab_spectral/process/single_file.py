"""Filtering and measuring a file in a child process, one per call.

The calling command can thus be interrupted, show progress, and report even a crash of MeshLab.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from meshlab_spectral.files.region import Region
from meshlab_spectral.files.sources import check_is_place, check_source
from meshlab_spectral.files.whole_files import remove_leftovers, resolved, writing_whole
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.process.ahead import process_for_job
from meshlab_spectral.process.parent import NO_LIMITS, JobLimits, ProgressCallback


def write_in_child(
    source: Path,
    target: Path,
    options: Options,
    on_progress: ProgressCallback,
    mesh: str | None = None,
    overwrite: bool = True,
    limits: JobLimits = NO_LIMITS,
    region: Region | None = None,
) -> dict[str, Any]:
    """Filter a mesh file into another, or write its harmonics to an archive, in a child process.

    The file is written atomically, and replaces an existing one if it may. `options` are those for
    `meshes.filter_to_scratch` or `basis.basis_to_scratch`, `on_progress` is that of
    `MeshLabProcess.run`, as are `limits`; without the name of a `mesh`, all meshes of the file are
    filtered, or of them only a `region`. Returns the filter's report; for harmonics, the numbers
    of "vertices" and "harmonics".

    Raises SpectralError when `source` cannot be read, `target` cannot be written, the filter
    rejects the mesh or an option, or the child died without an answer. KeyboardInterrupt passes
    after the child has been ended and the scratch files removed.
    """
    check_source(source)
    check_is_place(target)
    remove_leftovers(resolved(target).parent, target.name)
    with writing_whole(target, overwrite) as scratch:
        place = {"scratch": str(scratch.absolute()), "region": region.given() if region else None}
        return measure_in_child(source, options, on_progress, mesh, place, limits)


def measure_in_child(
    source: Path,
    options: Options | None,
    on_progress: ProgressCallback,
    mesh: str | None = None,
    more: dict[str, Any] | None = None,
    limits: JobLimits = NO_LIMITS,
) -> dict[str, Any]:
    """Measure a mesh file in a child process: its spectrum or, without options, `mesh_info`.

    Parameters and errors are those of `write_in_child`; `more` extends the child's job.
    """
    check_source(source)
    task = {"task": options.TABLE, "options": options.as_dict()} if options else {"task": "info"}
    job = {**task, "source": str(source.absolute()), "mesh": mesh, **(more or {})}
    with process_for_job() as process:
        return process.run(job, on_progress, limits).report
