"""Mesh files: read one, filter it, write one."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import FormatError, MeshFileError
from meshlab_spectral.files.claims import check_claims
from meshlab_spectral.files.dropped import check_nothing_dropped
from meshlab_spectral.files.script import apply_script
from meshlab_spectral.files.whole_files import USUAL_FORMATS, resolved, writing_whole
from meshlab_spectral.filters.calling import call_filter, plain_report, reason_of
from meshlab_spectral.filters.fractional import DETAILS
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.plugin.loading import load

StageCallback = Callable[[str], None]

# Formats in which MeshLab joins triangles again that it read as one polygon.
_POLYGON_FORMATS = (".obj", ".off")


def filter_file(
    source: Path,
    target: Path,
    options: Options,
    on_stage: StageCallback = lambda stage: None,
) -> dict[str, Any]:
    """Filter a mesh file into another.

    Parameters
    ----------
    source
        A file that pymeshlab can read, with one mesh in it.
    target
        The file to write, atomically. An existing one is replaced.
    options
        Options of the filter.
    on_stage
        Called with "reading", "filtering" and "writing" as these begin.

    Returns
    -------
    dict
        The filter's report, as from `filter_mesh`.

    Raises
    ------
    MeshFileError
        When `source` cannot be read or `target` cannot be written.
    FormatError
        When pymeshlab cannot write the extension of `target`.
    FilterError
        When the filter rejects the mesh or the options.
    """
    check_source(source)
    with writing_whole(target) as scratch:
        return filter_to_scratch(source, scratch, options, on_stage)


def filter_to_scratch(
    source: Path,
    scratch: Path,
    options: Options,
    on_stage: StageCallback,
    verbose: bool = True,
) -> dict[str, Any]:
    """Filter `source` into `scratch`, a file from `writing_whole`.

    Parameters and errors as in `filter_file`; after an error `scratch` may be incomplete. With
    `verbose`, MeshLab writes its log, the only source of progress.
    """

    def apply(mesh_set: Any) -> dict[str, Any]:
        parameters = options.pymeshlab_parameters(mesh_set.current_mesh())
        return plain_report(call_filter(mesh_set, options.FILTER, parameters))

    if not isinstance(options, FilterOptions) or options.result != "details":
        return _process(source, scratch, apply, on_stage, verbose)
    if scratch.suffix.lower() != ".ply":
        raise FormatError(f"{scratch.name} cannot hold details: choose .ply")
    return _process(source, scratch, apply, on_stage, verbose, {f"__ca_vp__{DETAILS}": True})


def script_to_scratch(
    source: Path, scratch: Path, script: str, on_stage: StageCallback, verbose: bool = True
) -> dict[str, Any]:
    """Apply the text of a MeshLab script to `source` and write the result to `scratch`.

    The result is the current mesh at the end of the script. Errors as in `filter_file` and
    `script.apply_script`, which also describes the report.
    """
    return _process(
        source, scratch, lambda mesh_set: apply_script(mesh_set, script), on_stage, verbose
    )


def _process(
    source: Path,
    scratch: Path,
    apply: Callable[[Any], dict[str, Any]],
    on_stage: StageCallback,
    verbose: bool,
    settings: dict[str, bool] | None = None,
) -> dict[str, Any]:
    import pymeshlab

    load()
    on_stage("reading")
    check_source(source)
    _check_name(scratch, scratch.parent.parent / scratch.name)
    _check_writable_format(scratch)
    mesh_set = pymeshlab.MeshSet(verbose=verbose)
    _read(mesh_set, source)
    on_stage("filtering")
    report = apply(mesh_set)
    on_stage("writing")
    _write(mesh_set, scratch, source, settings or {})
    return report


def load_arrays(source: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Read a mesh file: n x 3 coordinates, m x 3 vertex indices of triangles.

    Raises
    ------
    MeshFileError
        When `source` cannot be read.
    """
    import pymeshlab

    check_source(source)
    mesh_set = pymeshlab.MeshSet()
    _read(mesh_set, source)
    mesh = mesh_set.current_mesh()
    return mesh.vertex_matrix().copy(), mesh.face_matrix().astype(np.int64)


def check_source(source: Path) -> None:
    """Raise MeshFileError unless `source` is a readable file."""
    if source.is_dir():
        raise MeshFileError(f"{source} is a folder: name a mesh file")
    if source.exists() and not source.is_file():
        raise MeshFileError(f"{source} is a device or a pipe, not a file: name a mesh file")
    _check_name(source, source)
    try:
        with source.open("rb"):
            pass
    except FileNotFoundError:
        raise MeshFileError(f"{source} does not exist: check the name and the folder") from None
    except OSError as error:
        raise MeshFileError(f"{source} cannot be read ({error.strerror})") from error


def _check_name(path: Path, shown: Path) -> None:
    """Raise MeshFileError, with the path `shown`, when pymeshlab cannot take a path."""
    try:
        str(path).encode()
    except UnicodeEncodeError as error:
        raise MeshFileError(
            f"{shown} is in a folder or has a name that is not UTF-8, which MeshLab cannot open: "
            "rename it"
        ) from error


def _check_writable_format(path: Path) -> None:
    """Fail before the long computation, not after it."""
    if not _is_writable(path.suffix):
        ending = f"ends in {path.suffix}" if path.suffix else "has no extension"
        raise FormatError(
            f"{path.name} {ending}, which MeshLab cannot write: choose {USUAL_FORMATS}"
        )


@functools.cache
def _is_writable(ending: str) -> bool:
    """Try to write a triangle: pymeshlab has no list of the formats it can write."""
    import pymeshlab

    mesh_set = pymeshlab.MeshSet()
    corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    mesh_set.add_mesh(pymeshlab.Mesh(corners, [[0, 1, 2]]))
    with tempfile.TemporaryDirectory() as folder:
        try:
            mesh_set.save_current_mesh(str(Path(folder) / f"probe{ending}"))
        except pymeshlab.PyMeshLabException:
            return False
    return True


def _read(mesh_set: Any, source: Path) -> None:
    import pymeshlab

    check_claims(source)
    try:
        mesh_set.load_new_mesh(str(source))
    except pymeshlab.PyMeshLabException as error:
        reason = reason_of(error)
        if reason.startswith("Unknown format"):
            raise MeshFileError(
                f"{source} ends in {source.suffix or 'nothing'}, which MeshLab cannot read as a "
                f"mesh: convert it to {USUAL_FORMATS}"
            ) from error
        raise MeshFileError(
            f"{source} cannot be read as a mesh ({reason}): the file is damaged or does not "
            "match its extension; export it again from the program that made it"
        ) from error
    if mesh_set.mesh_number() > 1:
        raise MeshFileError(
            f"{source} holds {mesh_set.mesh_number()} meshes: merge them in MeshLab with 'Flatten "
            "Visible Layers', or save them separately"
        )
    mesh = mesh_set.current_mesh()
    check_nothing_dropped(source, mesh.vertex_number(), mesh.face_number())


def _write(mesh_set: Any, scratch: Path, source: Path, settings: dict[str, bool]) -> None:
    import pymeshlab

    settings = {
        **settings,
        "save_textures": _textures_to_be_saved(mesh_set, scratch, source),
    }
    if scratch.suffix.lower() in _POLYGON_FORMATS and _has_non_manifold_edges(mesh_set):
        # MeshLab would trace its polygons without end and use up all memory.
        settings["save_polygonal"] = False
    try:
        mesh_set.save_current_mesh(str(scratch), **settings)
    except pymeshlab.PyMeshLabException as error:
        reason = reason_of(error).rsplit(": ", 1)[-1]  # without the scratch file's name
        raise MeshFileError(
            f"{scratch.name} cannot be written ({reason}): is the disk full?"
        ) from error


def _has_non_manifold_edges(mesh_set: Any) -> bool:
    """Whether any edge has more than two faces."""
    F = mesh_set.current_mesh().face_matrix()
    edges = np.sort(np.vstack([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    _, faces = np.unique(edges, axis=0, return_counts=True)
    return bool((faces > 2).any())


def _textures_to_be_saved(mesh_set: Any, scratch: Path, source: Path) -> bool:
    """Whether to save copies of the texture images next to the output.

    Not next to the input, where they already are. And not if the mesh refers to an image outside
    its own folder, which would be written outside the scratch folder, over whatever is there.
    """
    names = [Path(name) for name in mesh_set.current_mesh().textures()]
    beside_input = scratch.parent.parent.samefile(resolved(source).parent)
    within = all(not name.is_absolute() and ".." not in name.parts for name in names)
    return within and not beside_input
