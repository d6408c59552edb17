"""Files of a batch: paths on this machine, or URLs that fsspec knows (s3://, sftp://, ...)."""

from __future__ import annotations

import contextlib
import hashlib
import posixpath
import re
import secrets
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from meshlab_spectral.errors import InputError, MeshFileError
from meshlab_spectral.files.meshes import check_source
from meshlab_spectral.files.whole_files import remove_leftovers, side_files, why_kept, writing_whole

_SCHEME = re.compile(r"[a-z][a-z0-9+.-]*(::|://)", re.IGNORECASE)
_PART = 2**20  # bytes that are read at once
_PARTIAL = re.compile(r"\..+\.[a-z0-9]{8}\.partial")


def is_url(place: str) -> bool:
    """Whether a place is a URL, not a path."""
    return bool(_SCHEME.match(place))


def located(place: str) -> str:
    """Give a place as every process knows it: an absolute path, or a URL of another scheme."""
    if place.startswith("file://"):
        place = unquote(urlsplit(place).path)
    return place if is_url(place) else str(Path(place).absolute())


def joined(folder: str, name: str) -> str:
    """Give the place of a name, which may hold folders of its own, within a folder."""
    return f"{folder.rstrip('/')}/{name}" if is_url(folder) else str(Path(folder, name))


def file_system(url: str) -> tuple[Any, str]:
    """Give fsspec's file system of a URL, and the path in it.

    Raises
    ------
    InputError
        When there is none, or its package is not installed.
    """
    import fsspec

    try:
        found: tuple[Any, str] = fsspec.core.url_to_fs(url)
    except (ImportError, ValueError) as error:
        raise InputError(f"{url} cannot be used ({error})") from error
    return found


def digest(path: Path) -> str:
    """Give the SHA-256 of a file."""
    with path.open("rb") as file:
        return _digest_of(file)


def digest_at(place: str) -> str | None:
    """Give the SHA-256 of a file at a path or a URL; None where there is none to be read."""
    try:
        if not is_url(place):
            return digest(Path(place)) if Path(place).is_file() else None
        fs, path = file_system(place)
        with fs.open(path, "rb") as file:
            return _digest_of(file)
    except OSError:
        return None


def existing(places: list[str]) -> list[str]:
    """Tell which places are taken, by whatever it is."""
    found = []
    for place in places:
        if is_url(place):
            fs, path = file_system(place)
            taken = fs.exists(path)
        else:
            taken = Path(place).exists() or Path(place).is_symlink()
        if taken:
            found.append(place)
    return found


@contextlib.contextmanager
def reading(place: str) -> Iterator[Path]:
    """Give a file to read: the one at a path, or a copy of the one at a URL.

    Raises
    ------
    MeshFileError
        When there is none, or it cannot be read.
    """
    if not is_url(place):
        check_source(Path(place))
        yield Path(place)
        return
    fs, path = file_system(place)
    with _scratch_folder() as folder:
        copy = folder / posixpath.basename(path)
        try:
            fs.get_file(path, str(copy))
        except FileNotFoundError:
            raise MeshFileError(f"{place} does not exist: check the URL") from None
        except OSError as error:
            raise MeshFileError(f"{place} cannot be read ({error})") from error
        yield copy


@contextlib.contextmanager
def writing(place: str, overwrite: bool) -> Iterator[Path]:
    """Give a scratch file to write; put it, and the files beside it, in place if all went well.

    Folders are made as needed. See `whole_files.writing_whole`; but a URL tells only shortly before
    the file is put there whether another one is.

    Raises
    ------
    MeshFileError
        When the place cannot be written to, or is taken and not to be overwritten.
    """
    if not is_url(place):
        try:
            Path(place).parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise MeshFileError(
                f"the folder of {place} cannot be made ({error.strerror})"
            ) from error
        with writing_whole(Path(place), overwrite) as scratch:
            yield scratch
        return
    fs, path = file_system(place)
    with _scratch_folder() as folder:
        scratch = folder / posixpath.basename(path)
        yield scratch
        if not scratch.is_file():
            raise MeshFileError(f"MeshLab wrote nothing for {place}: choose another format")
        try:
            if not overwrite and fs.exists(path) and digest_at(place) != digest(scratch):
                raise MeshFileError(why_kept(place))
            # The mesh last: what it refers to is there when it appears.
            for file in [*side_files(scratch), scratch]:
                name = file.relative_to(folder).as_posix()
                _upload(fs, file, posixpath.join(posixpath.dirname(path), name))
        except OSError as error:
            raise MeshFileError(f"{place} cannot be written ({error})") from error


def beside(place: str, name: str) -> str:
    """Give the place of a file beside another one, by its name relative to that one's folder."""
    if is_url(place):
        return f"{place.rpartition('/')[0]}/{name}"
    return str(Path(place).resolve().parent / name)  # through a symbolic link, as it was written


def tidy(folder: str) -> None:
    """Remove what a killed batch has left in a folder of outputs, half-written."""
    if not is_url(folder):
        remove_leftovers(Path(folder))
        return
    fs, path = file_system(folder)
    with contextlib.suppress(OSError):
        for found in fs.ls(path, detail=False):
            if _PARTIAL.fullmatch(posixpath.basename(found.rstrip("/"))):
                fs.rm(found)


@contextlib.contextmanager
def _scratch_folder() -> Iterator[Path]:
    """Make a folder for copies, in that of the Dask worker: Dask tidies up after a killed one."""
    from distributed import get_worker

    try:
        parent = get_worker().local_directory
    except ValueError:  # outside of a worker
        parent = None
    with tempfile.TemporaryDirectory(prefix="meshlab-spectral-", dir=parent) as folder:
        yield Path(folder)


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
