"""Filtering and measuring a file in a child process, one per call.

The calling command can thus be interrupted, show progress, and report even a crash of MeshLab.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from meshlab_spectral.files.basis import check_basis_target
from meshlab_spectral.files.meshes import check_source
from meshlab_spectral.files.whole_files import remove_leftovers, resolved, writing_whole
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import Boundary, LaplacianKind
from meshlab_spectral.filters.spectrum import GeometrySpectrum, spectrum_parameters
from meshlab_spectral.process.parent import MeshLabProcess, ProgressCallback


def filter_file_in_child(
    source: Path,
    target: Path,
    options: Options,
    on_progress: ProgressCallback = lambda stage, fraction: None,
    mesh: str | None = None,
) -> dict[str, Any]:
    """Filter a mesh file into another, in a child process that can be interrupted.

    Parameters
    ----------
    source, target, options
        As for `meshes.filter_file`.
    on_progress
        Called with the current stage and the fraction done, 0 to 1, or None if unknown.
    mesh
        Only the mesh of this name; by default all of the file.

    Returns
    -------
    dict
        The filter's report.

    Raises
    ------
    SpectralError
        As `meshes.filter_file`; also when the child died without an answer.
    KeyboardInterrupt
        After the child has been ended and the scratch files removed.
    """
    job = {"task": options.TABLE, "options": options.as_dict(), "mesh": mesh}
    return _write_in_child(source, target, job, on_progress)


def basis_file_in_child(
    source: Path,
    target: Path,
    basis_size: int,
    laplacian: LaplacianKind,
    boundary: Boundary,
    on_progress: ProgressCallback = lambda stage, fraction: None,
    mesh: str | None = None,
) -> dict[str, Any]:
    """Write the manifold harmonics of a mesh file to a NumPy archive.

    Parameters
    ----------
    source
        A mesh file.
    target
        The .npz file to write, atomically, with the arrays of `basis.basis_to_scratch`. An existing
        one is replaced.
    basis_size, laplacian, boundary
        As for `harmonics.manifold_harmonics`.
    on_progress, mesh
        As for `filter_file_in_child`.

    Returns
    -------
    dict
        The numbers of "vertices" and "harmonics".

    Raises
    ------
    SpectralError
        When `source` cannot be read, `target` cannot be written or is not named .npz, or the filter
        rejects the mesh or an option; also when the child died without an answer.
    KeyboardInterrupt
        After the child has been ended and the scratch files removed.
    """
    check_basis_target(target)
    options = {"basis_size": basis_size, "laplacian": laplacian, "boundary": boundary}
    job = {"task": "basis", "options": options, "mesh": mesh}
    return _write_in_child(source, target, job, on_progress)


def _write_in_child(
    source: Path, target: Path, job: dict[str, Any], on_progress: ProgressCallback
) -> dict[str, Any]:
    check_source(source)
    remove_leftovers(resolved(target).parent, target.name)
    with writing_whole(target) as scratch:
        job |= {"source": str(source.absolute()), "scratch": str(scratch.absolute())}
        return _run_in_child(job, on_progress)


def measure_spectrum_in_child(
    source: Path,
    basis_size: int,
    laplacian: LaplacianKind,
    boundary: Boundary,
    on_progress: ProgressCallback = lambda stage, fraction: None,
    mesh: str | None = None,
) -> GeometrySpectrum:
    """Measure the geometry spectrum of a mesh file, in a child process that can be interrupted.

    Parameters
    ----------
    source
        A mesh file.
    basis_size, laplacian, boundary
        As for `spectrum.geometry_spectrum`.
    on_progress, mesh
        As for `filter_file_in_child`.

    Raises
    ------
    SpectralError
        As `load_arrays` and `geometry_spectrum`; also when the child died without an answer.
    KeyboardInterrupt
        After the child has been ended.
    """
    check_source(source)
    job = {
        "task": "spectrum",
        "source": str(source.absolute()),
        "mesh": mesh,
        "parameters": spectrum_parameters(basis_size, laplacian, boundary),
    }
    return GeometrySpectrum.from_report(_run_in_child(job, on_progress))


def mesh_info_in_child(
    source: Path,
    on_progress: ProgressCallback = lambda stage, fraction: None,
    mesh: str | None = None,
) -> dict[str, Any]:
    """Describe a mesh file, see `info.mesh_info`, in a child process that can be interrupted.

    Parameters and errors are those of `measure_spectrum_in_child`.
    """
    check_source(source)
    return _run_in_child(
        {"task": "info", "source": str(source.absolute()), "mesh": mesh}, on_progress
    )


def _run_in_child(job: dict[str, Any], on_progress: ProgressCallback) -> dict[str, Any]:
    with MeshLabProcess() as process:
        return process.run(job, on_progress).report
