"""Mesh files: read one, filter it, write one; an output file is whole or absent."""

from __future__ import annotations

import contextlib
import filecmp
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.calling import call_filter, reason_of
from meshlab_spectral.errors import FormatError, MeshFileError
from meshlab_spectral.options import FilterOptions
from meshlab_spectral.plugin import FILTER_NAME, load

StageCallback = Callable[[str], None]

_USUAL_FORMATS = ".ply, .obj, .stl or .off"


def filter_file(
    source: Path,
    target: Path,
    options: FilterOptions,
    on_stage: StageCallback = lambda stage: None,
) -> dict[str, Any]:
    """Filter the mesh of one file into another.

    Parameters
    ----------
    source
        A file that pymeshlab reads, with one mesh in it.
    target
        The file to write. It appears whole, in place of an existing one, or not at all.
    options
        Options of the filter.
    on_stage
        Called with "reading", "filtering" and "writing" when these begin.

    Returns
    -------
    dict
        The filter's report: numbers, and lists for vectors; lengths in the units of the mesh.

    Raises
    ------
    MeshFileError
        When `source` cannot be read or `target` cannot be written.
    FormatError
        When pymeshlab has no writer for the ending of `target`.
    FilterError
        When the filter refuses the mesh or the options.
    """
    check_source(source)
    with writing_whole(target) as scratch:
        return filter_to_scratch(source, scratch, options, on_stage)


def filter_to_scratch(
    source: Path, scratch: Path, options: FilterOptions, on_stage: StageCallback
) -> dict[str, Any]:
    """Filter `source` into `scratch`, a file from `writing_whole`.

    Parameters and errors are those of `filter_file`; after an error `scratch` may be half-written.
    """
    import pymeshlab

    load()
    on_stage("reading")
    _check_writable_format(scratch)
    mesh_set = pymeshlab.MeshSet(verbose=True)  # its log is the only source of progress
    _read(mesh_set, source)
    on_stage("filtering")
    report = call_filter(mesh_set, FILTER_NAME, options.pymeshlab_parameters())
    on_stage("writing")
    _write(mesh_set, scratch, source)
    return plain_report(report)


def load_arrays(source: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Read the mesh of one file: n x 3 coordinates, m x 3 indices of the corners of triangles.

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
    """Raise MeshFileError unless `source` is a file that can be read."""
    if source.is_dir():
        raise MeshFileError(f"{source} is a folder: name a mesh file")
    try:
        with source.open("rb"):
            pass
    except FileNotFoundError:
        raise MeshFileError(f"{source} does not exist: check the name and the folder") from None
    except OSError as error:
        raise MeshFileError(f"{source} cannot be read ({error.strerror})") from error


@contextlib.contextmanager
def writing_whole(target: Path) -> Iterator[Path]:
    """Give a scratch file to write instead of `target`; put it in place when all went well.

    The scratch file has the name of `target` and lies in a hidden folder beside it, so that files
    that a format keeps beside the mesh (materials, textures) are caught, too, and refer to each
    other by their final names. After an error, nothing of all this remains.

    Yields
    ------
    Path
        The scratch file; it does not exist yet.

    Raises
    ------
    MeshFileError
        When the folder of `target` is missing or takes no files (before anything is yielded), or
        when the scratch file is not there at the end.
    """
    place = target.resolve()  # through a symbolic link, as cp does
    scratch_folder = _scratch_folder(target, place)
    try:
        scratch = scratch_folder / target.name
        yield scratch
        try:
            _put_in_place(scratch, place)
        except OSError as error:
            raise MeshFileError(f"{target} cannot be written ({error.strerror})") from error
    finally:
        shutil.rmtree(scratch_folder, ignore_errors=True)


def check_target(target: Path) -> None:
    """Raise MeshFileError where `writing_whole` would: before work that would be lost."""
    _scratch_folder(target, target.resolve()).rmdir()


def _scratch_folder(target: Path, place: Path) -> Path:
    """Make a hidden folder beside `place`, which `target` resolves to."""
    folder = place.parent
    if place.exists() and not place.is_file():
        raise MeshFileError(f"{target} is no file but a folder or a device: name a file to write")
    if not folder.is_dir():
        raise MeshFileError(
            f"the folder {target.parent} of the output does not exist: create it first"
        )
    try:
        return Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=folder))
    except OSError as error:
        raise MeshFileError(
            f"the folder {target.parent} of the output cannot be written to ({error.strerror}): "
            "choose another folder"
        ) from error


def _put_in_place(scratch: Path, place: Path) -> None:
    if not scratch.is_file() or scratch.stat().st_size == 0:
        raise MeshFileError(
            f"MeshLab wrote nothing for {scratch.name}: choose another format, {_USUAL_FORMATS}"
        )
    moves = {
        path: place.parent / path.relative_to(scratch.parent)
        for path in sorted(scratch.parent.rglob("*"))
        if path.is_file() and path != scratch
    }
    for path, side_place in moves.items():
        _check_side_file(path, side_place, scratch.name)
    if place.exists():
        shutil.copymode(place, scratch)
    moves[scratch] = place  # last: what the mesh refers to is there when it appears
    for path, final in moves.items():
        final.parent.mkdir(parents=True, exist_ok=True)
        _sync(path)
        path.replace(final)
    _sync(place.parent)


def _check_side_file(path: Path, place: Path, mesh_name: str) -> None:
    """Refuse to replace a file that the user did not name, such as another model's texture."""
    ours = place.name.startswith(mesh_name)  # out.obj.mtl of out.obj
    if ours or not place.exists():
        return
    if not (place.is_file() and filecmp.cmp(path, place, shallow=False)):
        raise MeshFileError(
            f"{mesh_name} needs a file {place.name} beside it, and another file has that name: "
            "write the output to a folder of its own"
        )


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _check_writable_format(path: Path) -> None:
    """Find out before the long computation; pymeshlab offers no list of the formats it writes."""
    import pymeshlab

    mesh_set = pymeshlab.MeshSet()
    corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    mesh_set.add_mesh(pymeshlab.Mesh(corners, [[0, 1, 2]]))
    with tempfile.TemporaryDirectory() as folder:
        try:
            mesh_set.save_current_mesh(str(Path(folder) / f"probe{path.suffix}"))
        except pymeshlab.PyMeshLabException as error:
            ending = f"ends in {path.suffix}" if path.suffix else "has no ending"
            raise FormatError(
                f"{path.name} {ending}, which MeshLab cannot write: end the name of the output in "
                f"{_USUAL_FORMATS}"
            ) from error


def _read(mesh_set: Any, source: Path) -> None:
    import pymeshlab

    try:
        mesh_set.load_new_mesh(str(source))
    except pymeshlab.PyMeshLabException as error:
        reason = reason_of(error)
        if reason.startswith("Unknown format"):
            raise MeshFileError(
                f"{source} ends in {source.suffix or 'nothing'}, which MeshLab cannot read as a "
                f"mesh: convert it to {_USUAL_FORMATS}"
            ) from error
        raise MeshFileError(
            f"{source} cannot be read as a mesh ({reason}): the file is damaged, or is not what "
            "its ending says; export it again from the program that made it"
        ) from error
    if mesh_set.mesh_number() > 1:
        raise MeshFileError(
            f"{source} holds {mesh_set.mesh_number()} meshes: merge them in MeshLab with 'Flatten "
            "Visible Layers', or save them one by one"
        )


def _write(mesh_set: Any, scratch: Path, source: Path) -> None:
    import pymeshlab

    try:
        mesh_set.save_current_mesh(
            str(scratch), save_textures=_textures_to_be_saved(mesh_set, scratch, source)
        )
    except pymeshlab.PyMeshLabException as error:
        reason = reason_of(error).rsplit(": ", 1)[-1]  # without the scratch file's name
        raise MeshFileError(
            f"{scratch.name} cannot be written ({reason}): is the disk full?"
        ) from error


def _textures_to_be_saved(mesh_set: Any, scratch: Path, source: Path) -> bool:
    """Whether copies of the texture images belong beside the output.

    Beside the input they are there already. And an image that the mesh refers to outside of its own
    folder would be written outside of the scratch folder, over whatever has its name there.
    """
    names = [Path(name) for name in mesh_set.current_mesh().textures()]
    beside_input = scratch.parent.parent.samefile(source.resolve().parent)
    within = all(not name.is_absolute() and ".." not in name.parts for name in names)
    return within and not beside_input


def plain_report(report: dict[str, Any]) -> dict[str, Any]:
    """Turn the arrays of a filter's report into lists, which JSON can hold."""
    return {
        name: value.tolist() if hasattr(value, "tolist") else value
        for name, value in report.items()
    }
