"""Output files written atomically: complete or absent, whatever happens meanwhile."""

from __future__ import annotations

import contextlib
import errno
import filecmp
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from meshlab_spectral.errors import MeshFileError

USUAL_FORMATS = ".ply, .obj, .stl or .off"

_SCRATCH_ENDING = ".partial"
_SCRATCH_NAME = re.compile(r"\.(?P<target>.+)\.[a-z0-9_]{8}\.partial")
_TEMPORARY = "meshlab-spectral"
LOCK = ".lock"  # in a scratch folder
_LONGEST_NAME = 200  # bytes of the output's name used in that of the scratch folder


@contextlib.contextmanager
def writing_whole(target: Path, overwrite: bool = True) -> Iterator[Path]:
    """Yield a scratch file to write instead of `target`; move it into place on success.

    The scratch file, which does not exist yet, has the name of `target` and lies in a hidden folder
    next to it, which also catches a format's side files (materials, textures) and lets them refer
    to each other by their final names. Nothing of it remains after an error. If the process is
    killed, its scratch folder remains: `remove_leftovers` recognizes it by its name.

    Where `overwrite`, an existing file is replaced, even one created meanwhile; one with the same
    contents does not count. Raises MeshFileError when the folder of `target` is missing or not
    writable (before the scratch file is yielded), when the scratch file has not been written, or
    when another file is in the way.
    """
    place = resolved(target)  # follow symbolic links, as cp does
    with _scratch_folder(target, place) as folder:
        scratch = folder / target.name
        yield scratch
        try:
            _put_in_place(scratch, place, overwrite)
        except OSError as error:
            code = "disk_full" if is_disk_full(error) else "not_written"
            raise MeshFileError(f"{target} cannot be written ({error.strerror})", code) from error


def is_disk_full(error: OSError) -> bool:
    """Whether a file cannot be written for lack of room, or a quota."""
    return error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def file_trouble(error: OSError, written: str = "a file") -> str:
    """Describe why a file cannot be read or written: `written`, unless the error names it."""
    name = Path(os.fsdecode(error.filename)).name if error.filename else written
    remedy = ": make room on the disk, or choose another folder" if is_disk_full(error) else ""
    return f"{name} cannot be read or written ({error.strerror}){remedy}"


def resolved(path: Path) -> Path:
    """Follow symbolic links, and stop at a loop of them, where Path.resolve raises an error."""
    return Path(os.path.realpath(path))


def check_target(target: Path) -> None:
    """Raise MeshFileError if `writing_whole` would, before any work is wasted."""
    with _scratch_folder(target, resolved(target)):
        pass


def remove_leftovers(folder: Path, target_name: str | None = None) -> None:
    """Remove the scratch folders left by killed processes in a folder, which need not exist.

    With `target_name`, only those of the output with this name.
    """
    try:
        entries = list(os.scandir(folder))
    except OSError:
        return
    for entry in entries:
        match = _SCRATCH_NAME.fullmatch(entry.name)
        if not match or not entry.is_dir(follow_symlinks=False):
            continue
        if target_name is not None and match["target"] != _shortened(target_name):
            continue
        with contextlib.suppress(OSError):
            with _locked(Path(entry.path)):
                shutil.rmtree(entry.path, ignore_errors=True)
            # Windows keeps the lock file as long as it is open.
            shutil.rmtree(entry.path, ignore_errors=True)


@contextlib.contextmanager
def temporary_folder(parent: Path) -> Iterator[Path]:
    """Make a folder, removed on exit, and first remove those that killed processes have left."""
    remove_leftovers(parent, _TEMPORARY)
    with contextlib.ExitStack() as stack:
        yield _make_locked(parent, _TEMPORARY, stack)


@contextlib.contextmanager
def holding(folder: Path) -> Iterator[None]:
    """Make a folder, if need be, and keep other processes of this kind out of it.

    Raises MeshFileError when one is at work there, or it cannot be made.
    """
    with contextlib.ExitStack() as stack:
        try:
            folder.mkdir(exist_ok=True)
            stack.enter_context(_locked(folder))
        except BlockingIOError:
            raise MeshFileError(f"another process is at work in {folder}: wait for it") from None
        except OSError as error:
            if not folder.is_dir():
                raise MeshFileError(f"{folder} cannot be made ({error.strerror})") from error
            # else a file system without locks
        yield


@contextlib.contextmanager
def _scratch_folder(target: Path, place: Path) -> Iterator[Path]:
    """Make a hidden folder next to `place`, which `target` resolves to; remove it on exit."""
    folder = place.parent
    if os.path.lexists(place) and not place.is_file():
        raise MeshFileError(
            f"{target} is a folder or a device, or a loop of links, not a file: name a file to "
            "write"
        )
    if not folder.is_dir():
        raise MeshFileError(f"the output folder {target.parent} does not exist: create it first")
    with contextlib.ExitStack() as stack:
        try:
            scratch = _make_locked(folder, target.name, stack)
        except OSError as error:
            raise MeshFileError(
                f"the output folder {target.parent} cannot be written to ({error.strerror}): "
                "choose another folder"
            ) from error
        yield scratch


def _make_locked(folder: Path, name: str, stack: contextlib.ExitStack) -> Path:
    """Make a scratch folder, locked for as long as this process lives, and removed by `stack`."""
    while True:
        path = Path(
            tempfile.mkdtemp(prefix=f".{_shortened(name)}.", suffix=_SCRATCH_ENDING, dir=folder)
        )
        stack.callback(shutil.rmtree, path, ignore_errors=True)
        try:
            stack.enter_context(_locked(path))
        except BlockingIOError:
            continue  # another process is removing it as a leftover
        except OSError:
            pass  # a file system without locks
        if path.is_dir():
            return path
        # Another process has removed it as a leftover.


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a scratch folder.

    Raises BlockingIOError when another process holds it, OSError when the file system has no locks.
    """
    from filelock import lock_descriptor  # a slow import

    with (folder / LOCK).open("ab") as file:
        if not lock_descriptor(file.fileno(), blocking=False):
            raise BlockingIOError
        yield


def _shortened(name: str) -> str:
    return os.fsencode(name)[:_LONGEST_NAME].decode(sys.getfilesystemencoding(), "ignore")


def side_files(scratch: Path) -> list[Path]:
    """Return the side files, such as textures, in the folder of a scratch file."""
    folder = scratch.parent
    ours = (scratch, folder / LOCK)
    return sorted(path for path in folder.rglob("*") if path.is_file() and path not in ours)


def _put_in_place(scratch: Path, place: Path, overwrite: bool) -> None:
    if not scratch.is_file() or scratch.stat().st_size == 0:
        raise MeshFileError(
            f"MeshLab wrote nothing for {scratch.name}: choose another format, {USUAL_FORMATS}"
        )
    moves = {path: place.parent / path.relative_to(scratch.parent) for path in side_files(scratch)}
    moves[scratch] = place  # last, when everything it refers to is in place
    # Such as out.obj.mtl of out.obj; a texture may belong to another mesh, too.
    replaceable = {path for path in moves if overwrite and path.name.startswith(scratch.name)}
    for path, final in moves.items():
        if path not in replaceable:
            _refuse_another(path, final, scratch)
    for path in moves:
        _sync(path)
    if place.exists():
        shutil.copymode(place, scratch)
    for path, final in moves.items():
        final.parent.mkdir(parents=True, exist_ok=True)
        if path in replaceable:
            path.replace(final)
        else:
            _put_new(path, final, scratch)
    _sync_folder(place.parent)


def _put_new(path: Path, place: Path, scratch: Path) -> None:
    """Move a file into place unless another process has just created one there."""
    try:
        place.hardlink_to(path)
    except FileExistsError:
        _refuse_another(path, place, scratch)
    except OSError:  # a file system without hard links
        path.replace(place)


def _refuse_another(path: Path, place: Path, scratch: Path) -> None:
    """Raise MeshFileError if another file is in the way, such as another model's texture."""
    if not place.exists() or (place.is_file() and filecmp.cmp(path, place, shallow=False)):
        return
    if path == scratch:
        raise MeshFileError(why_kept(place))
    raise MeshFileError(
        f"{scratch.name} needs a file {place.name} next to it, but another file has that name: "
        "write the output to a folder of its own"
    )


def why_kept(place: object) -> str:
    """Return the message for a file that appeared during the work, and is not replaced."""
    return (
        f"{place} has meanwhile been written by another program and is kept: choose another "
        "folder, or replace it with --overwrite"
    )


def _sync(path: Path) -> None:
    # Windows flushes only what is open for writing; a copy of a texture may be read-only.
    with contextlib.suppress(PermissionError), path.open("r+b") as file:
        os.fsync(file.fileno())


def _sync_folder(folder: Path) -> None:
    with contextlib.suppress(PermissionError):  # Windows cannot open folders
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
