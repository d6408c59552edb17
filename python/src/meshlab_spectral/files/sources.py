"""Checks of input files before they are read."""

from __future__ import annotations

import re
from pathlib import Path

from meshlab_spectral.errors import MeshFileError

_URL = re.compile(r"[a-z][a-z0-9+.-]+:/", re.IGNORECASE)
_BATCH = "`meshlab-spectral batch {} --output FOLDER`"


def check_source(source: Path) -> None:
    """Raise MeshFileError, with a remedy and the cause as its code, unless it is a file to read."""
    if source.is_dir():
        raise MeshFileError(
            f"{source} is a folder: name a mesh file, or filter all in it with "
            f"{_BATCH.format(source)}",
            "no_file",
        )
    if source.exists() and not source.is_file():
        raise MeshFileError(
            f"{source} is a device or a pipe, not a file: name a mesh file", "no_file"
        )
    check_name(source, source)
    if source.suffix.lower() == ".txt":
        raise MeshFileError(
            f"{source} ends in .txt, which no format of meshes does: if it holds one, name it "
            "after its format, such as .ply, .obj, .stl or .off",
            "unknown_format",
        )
    try:
        with source.open("rb"):
            pass
    except FileNotFoundError:
        raise MeshFileError(*_missing(source)) from None
    except OSError as error:
        raise MeshFileError(f"{source} cannot be read ({error.strerror})", "no_access") from error


def _missing(source: Path) -> tuple[str, str]:
    if str(source) == "-":
        return (
            "- is not a file: only filter and denoise read standard input; name a file",
            "no_file",
        )
    if _URL.match(str(source)):
        url = str(source).replace(":/", "://", 1)
        return f"{url} is a URL, which {_BATCH.format(url)} reads: or download it first", "no_file"
    return f"{source} does not exist: check the name and the folder", "missing"


def check_is_place(target: Path) -> None:
    """Raise MeshFileError if an output is not a file: - or a URL."""
    if str(target) == "-":
        text = (
            "- is not a file: only filter and denoise write a mesh to standard output; name a file"
        )
    elif _URL.match(str(target)) and not target.parent.is_dir():
        url = str(target).replace(":/", "://", 1)
        text = f"{url} is a URL, to which only `meshlab-spectral batch` writes: name a file"
    else:
        return
    raise MeshFileError(text, "not_written")


def check_name(path: Path, shown: Path) -> None:
    """Raise MeshFileError, with the path as `shown`, when pymeshlab cannot open such a path."""
    try:
        str(path).encode()
    except UnicodeEncodeError as error:
        raise MeshFileError(
            f"{shown} is in a folder or has a name that is not UTF-8, which MeshLab cannot open: "
            "rename it",
            "bad_name",
        ) from error
