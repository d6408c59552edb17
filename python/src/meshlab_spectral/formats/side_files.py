"""Files that a mesh file refers to by name, such as textures: one guard for all formats."""

from __future__ import annotations

import filecmp
import os
import shutil
from collections.abc import Iterable
from pathlib import Path, PureWindowsPath

from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.formats.names import shown
from meshlab_spectral.warned import Warned


def beside(source: Path, name: str) -> Path:
    """Return the file `name` that the mesh file `source` refers to.

    It is in the folder of `source` or below, links resolved: what a stranger's file names must not
    be read from elsewhere, nor from a device. Raises MeshFileError, which says why, if it is not.
    """
    found = source.parent / name
    why = ""
    if "\0" in name:
        why = "is not a file name"
    elif is_outside(source, name):
        why = "is outside its folder: keep it next to the mesh"
    elif not os.path.isfile(found):  # noqa: PTH113 - false for impossible names, too
        why = "is not a file" if os.path.lexists(found) else "is missing"
    if why:
        raise MeshFileError(f"{shown(name)}, which {source.name} refers to, {why}", "side_file")
    return Path(os.path.realpath(found))


def is_outside(source: Path, name: str) -> bool:
    """Whether a name leads out of the folder of `source`, by itself or by links."""
    path = PureWindowsPath(name)  # accepts both kinds of slashes
    if path.anchor or ".." in path.parts:
        return True
    found = Path(os.path.realpath(source.parent / name))
    folders = os.path.realpath(source.parent), os.path.dirname(os.path.realpath(source))  # noqa: PTH120
    return not any(map(found.is_relative_to, folders))


def copy_side_files(source: Path, target: Path, names: Iterable[str]) -> list[Warned]:
    """Copy the files `names` that `source` refers to next to `target`, and never elsewhere.

    Returns a warning for each file that cannot be copied. Nothing is copied into the folder of
    `source`, nor into a scratch folder in it. Raises OSError when a file cannot be written.
    """
    if source.resolve().parent in target.resolve().parents[:2]:
        return []
    warnings = (_copy(source, target.parent, name) for name in dict.fromkeys(names))
    return [Warned("side_file", warning) for warning in warnings if warning]


def _copy(source: Path, target: Path, name: str) -> str | None:
    """Copy one file into a folder; return a warning if that is not possible."""
    try:
        origin = beside(source, name)
    except MeshFileError as error:
        return str(error)
    copy = target / name
    if not copy.resolve().is_relative_to(target.resolve()):
        return f"{shown(name)} is not copied: a link in the output folder leads elsewhere"
    if not copy.exists():
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(origin, copy)
    elif not copy.is_file() or not filecmp.cmp(origin, copy, shallow=False):
        return f"{shown(name)} is not copied: another file has that name"
    return None
