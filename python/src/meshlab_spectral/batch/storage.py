"""Files of a batch: local paths, or URLs supported by fsspec (s3://, sftp://, ...)."""

from __future__ import annotations

import contextlib
import hashlib
import os
import posixpath
import re
import secrets
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from meshlab_spectral.errors import InputError, MeshFileError
from meshlab_spectral.files.sources import check_source
from meshlab_spectral.files.whole_files import (
    remove_leftovers,
    resolved,
    side_files,
    why_kept,
    writing_whole,
)

# Schemes may be chained, as in filecache::s3://; a::b.ply, however, is a file name.
_SCHEME = re.compile(r"([a-z][a-z0-9+.-]*::)*[a-z][a-z0-9+.-]*://", re.IGNORECASE)
# Extras of fsspec that are not called like the scheme.
_EXTRAS = {"https": "http", "gs": "gcs", "gcs": "gcs", "az": "abfs", "abfss": "abfs", "sftp": "ssh"}
_PART = 2**20  # bytes per read
_PARTIAL = re.compile(r"\..+\.[a-z0-9]{8}\.partial")


def is_url(location: str) -> bool:
    """Whether a location is a URL, not a path."""
    return bool(_SCHEME.match(location))


def absolute_location(location: str) -> str:
    """Resolve a location to an absolute path with "/", or to a URL other than file://."""
    if location.startswith("file://"):
        from urllib.request import url2pathname  # a slow import

        location = url2pathname(urlsplit(location).path)
    return location if is_url(location) else Path(location).absolute().as_posix()


def location_in(folder: str, name: str) -> str:
    """Join a folder and a relative name."""
    return f"{folder.rstrip('/')}/{name}" if is_url(folder) else Path(folder, name).as_posix()


def file_system(url: str) -> tuple[Any, str]:
    """Return the fsspec file system of a URL and the path in it.

    Raises InputError when the scheme is unknown or its package is not installed.
    """
    import fsspec  # slow

    try:
        found: tuple[Any, str] = fsspec.core.url_to_fs(url)
    except (ImportError, ValueError) as error:
        scheme = url.partition("://")[0].rpartition("::")[2].lower()
        extra = _EXTRAS.get(scheme, scheme)
        raise InputError(
            f"{url} cannot be used ({error}): if fsspec knows {scheme}://, `pip install "
            f"'fsspec[{extra}]'` installs what it needs for that"
        ) from error
    return found


def digest(path: Path) -> str:
    """Return the SHA-256 of a file."""
    with path.open("rb") as file:
        return _digest_of(file)


def digest_at(location: str) -> str | None:
    """Return the SHA-256 of the file at a path or URL; None if it cannot be read."""
    try:
        if not is_url(location):
            return digest(Path(location)) if Path(location).is_file() else None
        fs, path = file_system(location)
        with fs.open(path, "rb") as file:
            return _digest_of(file)
    except OSError:
        return None


def existing(locations: list[str]) -> list[str]:
    """Return the locations that exist, as files or otherwise."""

    def exists(location: str) -> bool:
        if not is_url(location):
            return os.path.lexists(location)
        fs, path = file_system(location)
        return bool(fs.exists(path))

    return [location for location in locations if exists(location)]


@contextlib.contextmanager
def reading(location: str, folder: Path) -> Iterator[Path]:
    """Yield a local file to read: the one at a path, or a copy of the one at a URL.

    The copy is made in `folder`. Raises MeshFileError when it is missing or cannot be read.
    """
    if not is_url(location):
        check_source(Path(location))
        yield Path(location)
        return
    fs, path = file_system(location)
    with tempfile.TemporaryDirectory(dir=folder) as scratch_folder:
        copy = Path(scratch_folder, posixpath.basename(path))
        try:
            fs.get_file(path, str(copy))
        except FileNotFoundError:
            raise MeshFileError(f"{location} does not exist: check the URL", "missing") from None
        except OSError as error:
            raise MeshFileError(f"{location} cannot be read ({error})", "no_access") from error
        yield copy


@contextlib.contextmanager
def writing(location: str, overwrite: bool, folder: Path) -> Iterator[Path]:
    """Yield a scratch file to write; on success, move it and its side files into their location.

    Folders are created as needed. See `whole_files.writing_whole`; a URL, however, is
    uploaded from a scratch file in `folder`, and an existing file only detected shortly before.
    Raises MeshFileError when it cannot be written to, or exists and must not be overwritten.
    """
    if not is_url(location):
        try:
            Path(location).parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise MeshFileError(
                f"the folder of {location} cannot be created ({error.strerror})"
            ) from error
        with writing_whole(Path(location), overwrite) as scratch:
            yield scratch
        return
    fs, path = file_system(location)
    with tempfile.TemporaryDirectory(dir=folder) as scratch_folder:
        scratch = Path(scratch_folder, posixpath.basename(path))
        yield scratch
        if not scratch.is_file():
            raise MeshFileError(f"MeshLab wrote nothing for {location}: choose another format")
        try:
            if not overwrite and fs.exists(path) and digest_at(location) != digest(scratch):
                raise MeshFileError(why_kept(location))
            # The mesh last, when everything it refers to is in place.
            for file in [*side_files(scratch), scratch]:
                name = file.relative_to(scratch_folder).as_posix()
                _upload(fs, file, posixpath.join(posixpath.dirname(path), name))
        except OSError as error:
            raise MeshFileError(f"{location} cannot be written ({error})") from error


def sibling(location: str, name: str) -> str:
    """Resolve a name relative to the folder of another file."""
    if is_url(location):
        return f"{location.rpartition('/')[0]}/{name}"
    return str(resolved(Path(location)).parent / name)  # follow symbolic links, as in writing


def tidy(folder: str) -> None:
    """Remove incomplete files that a killed batch has left in an output folder."""
    if not is_url(folder):
        remove_leftovers(Path(folder))
        return
    fs, path = file_system(folder)
    with contextlib.suppress(OSError):
        for found in fs.ls(path, detail=False):
            if _PARTIAL.fullmatch(posixpath.basename(found.rstrip("/"))):
                fs.rm(found)


def _upload(fs: Any, file: Path, path: str) -> None:
    folder, name = posixpath.split(path)
    fs.makedirs(folder, exist_ok=True)
    partial = posixpath.join(folder, f".{name}.{secrets.token_hex(4)}.partial")
    try:
        fs.put_file(str(file), partial)
        fs.mv(partial, path)
    except BaseException:
        with contextlib.suppress(OSError):
            fs.rm(partial)
        raise


def _digest_of(file: Any) -> str:
    sha256 = hashlib.sha256()
    while part := file.read(_PART):
        sha256.update(part)
    return sha256.hexdigest()
