"""Files that a mesh file refers to by name, such as textures."""

from __future__ import annotations

import filecmp
import os
import shutil
from collections.abc import Iterable
from pathlib import Path, PureWindowsPath


def copy_side_files(source: Path, target: Path, names: Iterable[str]) -> list[str]:
    """Copy the files `names` that `source` refers to next to `target`, and never elsewhere.

    Returns a warning for each file that cannot be copied. Nothing is copied into the folder of
    `source`, nor into a scratch folder in it. Raises OSError when a file cannot be written.
    """
    folder = source.resolve().parent
    if folder in target.resolve().parents[:2]:
        return []
    warnings = (_copy(folder, target.parent, name, source.name) for name in dict.fromkeys(names))
    return [warning for warning in warnings if warning]


def _copy(source: Path, target: Path, name: str, referrer: str) -> str | None:
    """Copy one file between folders; return a warning if that is not possible."""
    path = PureWindowsPath(name)  # accepts both kinds of slashes
    if path.anchor or ".." in path.parts:
        return f"{name}, which {referrer} refers to, is outside its folder and is not copied"
    origin, copy = source / name, target / name
    if not os.path.isfile(origin):  # noqa: PTH113 - false for impossible names, too
        return f"{name}, which {referrer} refers to, is missing"
    if not copy.resolve().is_relative_to(target.resolve()):
        return f"{name} is not copied: a link in the output folder leads elsewhere"
    if not copy.exists():
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(origin, copy)
    elif not copy.is_file() or not filecmp.cmp(origin, copy, shallow=False):
        return f"{name} is not copied: another file has that name"
    return None
