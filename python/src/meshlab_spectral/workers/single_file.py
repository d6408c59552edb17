"""Filtering, measuring and comparing files in a child process, one per call.

The calling command can thus be interrupted, show progress, and report even a crash of MeshLab.
"""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshlab_spectral.files.region import Region
from meshlab_spectral.files.sources import check_is_place, check_source
from meshlab_spectral.files.whole_files import (
    remove_leftovers,
    resolved,
    temporary_folder,
    writing_whole,
)
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import TextureOptions
from meshlab_spectral.workers.process import NO_LIMITS, JobLimits, ProgressCallback, process_for_job

if TYPE_CHECKING:
    from meshlab_spectral.files.comparison import Comparison
    from meshlab_spectral.filters.texture import SurfaceTexture


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
    more = {"max_distance": max_distance}
    with _archive(whole) as archive, process_for_job() as process:
        report = process.run(
            {**job, **more, "archive": archive and str(archive)}, on_progress
        ).report
        from meshlab_spectral.files.comparison import Comparison  # a slow import

        return Comparison.from_report(report, archive)


def texture_in_child(
    source: Path,
    options: TextureOptions,
    on_progress: ProgressCallback,
    mesh: str | None,
    whole: bool,
    region: Region,
) -> tuple[Any, Any, SurfaceTexture]:
    """Measure the texture of a mesh file in a child process, as `texture_of` does.

    Returns vertices and faces, too; they and the heights of the vertices are left out unless the
    `whole` is asked for.
    """
    with _archive(whole) as archive:
        more = {"archive": archive and str(archive), "region": region.given()}
        report = measure_in_child(source, options, on_progress, mesh, more)
        import numpy as np  # a slow import, as is what needs it

        from meshlab_spectral.filters.texture import SurfaceTexture

        if archive is None:
            return None, None, SurfaceTexture.from_report(report, np.zeros(0))
        with np.load(archive) as saved:
            texture = SurfaceTexture.from_report(report, saved["height"])
            return saved["vertices"], saved["faces"], texture


@contextlib.contextmanager
def _archive(wanted: bool) -> Iterator[Path | None]:
    """Yield the name of a temporary file for arrays from the child, if it is wanted."""
    if not wanted:
        yield None
        return
    with temporary_folder(Path(tempfile.gettempdir())) as folder:
        yield folder / "arrays.npz"
