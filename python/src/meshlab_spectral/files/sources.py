"""Checks of input files before they are read."""

from __future__ import annotations

from pathlib import Path

from meshlab_spectral.errors import MeshFileError


def check_source(source: Path) -> None:
    """Raise MeshFileError unless `source` is a readable file."""
    if source.is_dir():
        raise MeshFileError(f"{source} is a folder: name a mesh file")
    if source.exists() and not source.is_file():
        raise MeshFileError(f"{source} is a device or a pipe, not a file: name a mesh file")
    check_name(source, source)
    try:
        with source.open("rb"):
            pass
    except FileNotFoundError:
        raise MeshFileError(f"{source} does not exist: check the name and the folder") from None
    except OSError as error:
        raise MeshFileError(f"{source} cannot be read ({error.strerror})") from error


def check_name(path: Path, shown: Path) -> None:
    """Raise MeshFileError, with the path as `shown`, when pymeshlab cannot open such a path."""
    try:
        str(path).encode()
    except UnicodeEncodeError as error:
        raise MeshFileError(
            f"{shown} is in a folder or has a name that is not UTF-8, which MeshLab cannot open: "
            "rename it"
        ) from error
