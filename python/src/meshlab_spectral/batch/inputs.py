"""Finding the input files of a batch."""

from __future__ import annotations

import glob
import os
import posixpath
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from meshlab_spectral.batch.storage import absolute_location, file_system, is_url
from meshlab_spectral.errors import InputError
from meshlab_spectral.files.extensions import SEARCHED
from meshlab_spectral.files.whole_files import resolved
from meshlab_spectral.formats.names import (
    QUADRILATERALS,
    TRIANGLES,
    ending_of,
    holds_values,
    is_free_surfer,
)


@dataclass(frozen=True)
class Input:
    """An input file; an unreadable one is an input, too, and its job fails."""

    location: str  # absolute path with "/", or URL
    folder: str = ""  # relative to the one given by the user; "" for that one itself
    is_free_surfer: bool = False  # a surface of FreeSurfer, whatever its extension

    @property
    def name(self) -> str:
        """File name without folders."""
        return posixpath.basename(self.location)


def find_inputs(
    arguments: Iterable[str], recursive: bool = False, leave_out: Collection[Path] = ()
) -> list[Input]:
    """Find the files given by names, folders, patterns such as scans/*.ply, and URLs.

    A named file is accepted whatever its extension; in folders, only visible files with that of a
    mesh are, and surfaces of FreeSurfer, but no GIFTI of values at vertices. If `recursive`,
    subfolders are searched, too, and ** in a pattern matches any folders; outputs, the files and
    folders to `leave_out`, are skipped. Inputs are in the order of the arguments, sorted within
    each, without duplicates. Raises InputError when an argument matches no file.
    """
    outputs = {resolved(path) for path in leave_out}
    found: dict[str, Input] = {}
    for argument in arguments:
        of_this = list(_from_argument(argument, recursive, outputs))
        if not of_this:
            hint = "" if recursive else "; --recursive searches its subfolders, too"
            raise InputError(f"{argument} holds no mesh that can be read{hint}")
        for file in of_this:
            key = file.location if is_url(file.location) else os.path.realpath(file.location)
            found.setdefault(key, file)
    return list(found.values())


def _from_argument(argument: str, recursive: bool, outputs: set[Path]) -> Iterator[Input]:
    location = absolute_location(argument)
    if is_url(location):
        yield from _from_url(location, recursive)
    elif os.path.lexists(location):
        yield from _from_path(Path(location), recursive, outputs)
    elif glob.has_magic(location):
        matches = sorted(glob.glob(location, recursive=recursive))  # noqa: PTH207 (hidden files)
        if not matches:
            raise InputError(f"{argument} matches no file: check the pattern and the folder")
        for match in matches:
            path = resolved(Path(match))
            if outputs.isdisjoint([path, *path.parents]):
                yield from _from_path(Path(match), recursive, outputs)
    else:
        raise InputError(f"{argument} does not exist: check the name and the folder")


def _from_path(path: Path, recursive: bool, outputs: set[Path]) -> Iterator[Input]:
    if not path.is_dir():
        yield Input(path.as_posix(), is_free_surfer=is_free_surfer(path))
        return
    within = list(_search(path, "", recursive, outputs))
    yield from within
    if not within and _looks_like_mesh(path.name):
        yield Input(path.as_posix())  # its job reports that it is a folder


def _search(folder: Path, relative: str, recursive: bool, outputs: set[Path]) -> Iterator[Input]:
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError as error:
        raise InputError(f"{folder} cannot be searched ({error.strerror})") from error
    for entry in entries:
        path = Path(entry.path)
        if entry.name.startswith(".") or resolved(path) in outputs:
            continue
        if entry.is_dir(follow_symlinks=False) and recursive:
            within = list(_search(path, posixpath.join(relative, entry.name), recursive, outputs))
            yield from within
            if within:
                continue
        is_surface = is_free_surfer(path)
        if is_surface or (_looks_like_mesh(entry.name) and not holds_values(path)):
            yield Input(path.as_posix(), relative, is_surface)


def _from_url(url: str, recursive: bool) -> Iterator[Input]:
    fs, path = file_system(url)
    try:
        if glob.has_magic(path):
            matches = sorted(fs.glob(path))
            if not matches:
                raise InputError(f"{url} matches no file: check the pattern and the folder")
            for match in matches:
                yield Input(fs.unstrip_protocol(match))
        elif fs.isdir(path):
            for file in sorted(fs.find(path, maxdepth=None if recursive else 1)):
                relative = posixpath.relpath(file, path)
                if any(part.startswith(".") for part in relative.split("/")):
                    continue
                is_surface = _begins_as_surface(fs, file)
                if is_surface or _looks_like_mesh(file):
                    folder = posixpath.dirname(relative)
                    yield Input(fs.unstrip_protocol(file), folder, is_surface)
        elif fs.exists(path):
            yield Input(fs.unstrip_protocol(path), is_free_surfer=_begins_as_surface(fs, path))
        else:
            raise InputError(f"{url} does not exist: check the URL")
    except OSError as error:
        raise InputError(f"{url} cannot be read ({error})") from error


def _begins_as_surface(fs: Any, path: str) -> bool:
    """Whether a file with a name as FreeSurfer gives begins as a surface of it."""
    if not posixpath.basename(path).startswith(("lh.", "rh.")) or _looks_like_mesh(path):
        return False
    with fs.open(path, "rb") as file:
        return file.read(len(TRIANGLES)) in (TRIANGLES, QUADRILATERALS)


def _looks_like_mesh(name: str) -> bool:
    return ending_of(posixpath.basename(name)).lower() in SEARCHED
