"""Files beside a mesh that it refers to by name, such as textures."""

from __future__ import annotations

import filecmp
import os
import shutil
from collections.abc import Iterable
from pathlib import Path, PureWindowsPath


def copy_side_files(source: Path, target: Path, names: Iterable[str]) -> list[str]:
    """Copy what a mesh file refers to beside a file made from it, and never elsewhere.

    Nothing is copied into the folder of `source`, nor into a scratch folder in it.

    Parameters
    ----------
    source
        The mesh file.
    target
        The file made from it.
    names
        Paths as they stand in `source`, relative to its folder.

    Returns
    -------
    list of str
        A warning for each file that is missing, or lies outside the folder.

    Raises
    ------
    OSError
        When a file cannot be copied.
    """
    folder = source.resolve().parent
    if folder in target.resolve().parents[:2]:
        return []
    warnings = (_copy(folder, target.parent, name, source.name) for name in dict.fromkeys(names))
    return [warning for warning in warnings if warning]


def _copy(source: Path, target: Path, name: str, referrer: str) -> str | None:
    """Copy one file between folders; return the warning if it must not be."""
    if not _is_within(name):
        return f"{name}, which {referrer} refers to, is outside its folder and is not copied"
    if not os.path.isfile(source / name):  # noqa: PTH113 - false for impossible names, too
        return f"{name}, which {referrer} refers to, is missing"
    copy = target / name
    if not copy.resolve().is_relative_to(target.resolve()):
        return f"{name} is not copied: a link in the output folder leads elsewhere"
    if copy.exists():
        same = copy.is_file() and filecmp.cmp(source / name, copy, shallow=False)
        return None if same else f"{name} is not copied: another file has that name"
    copy.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source / name, copy)
    return None


def _is_within(name: str) -> bool:
    """Whether a path is relative, on any system, and does not lead upwards."""
    path = PureWindowsPath(name)  # which takes both kinds of slashes
    return not path.anchor and ".." not in path.parts
