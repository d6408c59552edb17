"""Filtering one file: `filter_file` and `denoise_file`, as the commands of these names."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from meshlab_spectral.errors import Cancelled, InputError
from meshlab_spectral.files.request import Request
from meshlab_spectral.filters.keywords import takes_options
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import (
    DenoiseKeywords,
    DenoiseOptions,
    FilterKeywords,
    FilterOptions,
)
from meshlab_spectral.filters.progress import Progress, progress_callback
from meshlab_spectral.filters.reports import DenoiseReport, FilterReport
from meshlab_spectral.tiles import whole_or_tiles

if TYPE_CHECKING:
    from typing_extensions import Unpack


@takes_options(FilterOptions)
def filter_file(
    source: str | Path,
    target: str | Path,
    options: FilterOptions | None = None,
    *,
    mesh: str | None = None,
    overwrite: bool = False,
    progress: Progress | bool | None = None,
    **named: Unpack[FilterKeywords],
) -> FilterReport:
    """Filter a mesh file: everything else that it holds is kept, as by the command `filter`.

    A child process reads it, and divides it into tiles where it does not fit in memory.

    Parameters
    ----------
    source, target
        Mesh files; in the same format only coordinates and normals change.
    options
        All options below in one object, instead of by name.
    mesh
        The only mesh to filter, by its name; by default all of the file, each by itself.
    overwrite
        Whether to replace a file that exists.
    progress
        As for `filter_mesh`.
    **named

    Returns
    -------
    FilterReport
        A dict, as from `filter_mesh`; of several meshes with a list of their reports, "meshes".

    Raises
    ------
    InputError
        When `target` exists, or is `source`.
    SpectralError
        As from `filter_mesh`; MeshFileError when a file cannot be read or written, FormatError when
        the ending of `target` is unknown.

    Examples
    --------
    >>> report = filter_file("scan.ply", "smooth.ply", feature_size="2%")
    """
    chosen = FilterOptions.from_call(options, named)
    return cast(FilterReport, _filtered(source, target, chosen, mesh, overwrite, progress))


@takes_options(DenoiseOptions)
def denoise_file(
    source: str | Path,
    target: str | Path,
    options: DenoiseOptions | None = None,
    *,
    mesh: str | None = None,
    overwrite: bool = False,
    progress: Progress | bool | None = None,
    **named: Unpack[DenoiseKeywords],
) -> DenoiseReport:
    """Remove the noise of a mesh file: everything else that it holds is kept.

    Parameters
    ----------
    source, target, mesh, overwrite, progress
        As for `filter_file`, which also says what is raised.
    options
        All options below in one object, instead of by name.
    **named

    Returns
    -------
    DenoiseReport
        A dict, as from `denoise_mesh`; of several meshes with a list of their reports, "meshes".

    Examples
    --------
    >>> print(denoise_file("scan.ply", "clean.ply")["summary"])
    """
    chosen = DenoiseOptions.from_call(options, named)
    return cast(DenoiseReport, _filtered(source, target, chosen, mesh, overwrite, progress))


def _filtered(
    source: str | Path,
    target: str | Path,
    options: Options,
    mesh: str | None,
    overwrite: bool,
    progress: Progress | bool | None,
) -> dict[str, Any]:
    read, written = Path(source), Path(target)
    if written.exists() and read.exists() and written.samefile(read):
        raise InputError(f"{target} is the input itself and would be lost: choose another name")
    if written.is_file() and not overwrite:
        raise InputError(f"{target} exists: choose another name, or replace it by overwrite=True")
    with progress_callback(progress) as on_progress:

        def update(stage: str, fraction: float | None) -> None:
            # A stage of unknown length is at its beginning.
            if on_progress is not None and on_progress(stage, fraction or 0.0) is False:
                raise Cancelled(f"stopped: {target} was not written")

        request = Request(read, options, mesh)
        return whole_or_tiles.filter_file(request, written, update, overwrite, 0, lambda _: None)
