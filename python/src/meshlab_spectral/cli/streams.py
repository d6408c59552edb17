"""`-` for a mesh on standard input or output, which pass through a temporary file."""

from __future__ import annotations

import contextlib
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import typer

from meshlab_spectral.errors import MeshFileError

STREAM = Path("-")


@contextlib.contextmanager
def as_files(source: Path, target: Path, ending: str | None) -> Iterator[tuple[Path, Path]]:
    """Yield files for both; what is written for a `target` of `-` is printed at the end.

    `ending` is the format of what is streamed, such as "ply".
    """
    if STREAM not in (source, target):
        yield source, target
        return
    if ending is None:
        raise typer.BadParameter("name the format of `-`, such as ply", param_hint="--format")
    if target == STREAM and sys.stdout.isatty():
        raise typer.BadParameter(
            "a mesh is not printed on a terminal: name a file, or redirect", param_hint="OUTPUT"
        )
    with tempfile.TemporaryDirectory() as folder:
        name = f"mesh.{ending.removeprefix('.')}"
        if source == STREAM:
            source = Path(folder, "input") / name
            source.parent.mkdir()
            with source.open("wb") as file:
                shutil.copyfileobj(sys.stdin.buffer, file)
        file_written = Path(folder, name) if target == STREAM else target
        try:
            yield source, file_written
        except MeshFileError as error:
            named = str(error).replace(str(source), "standard input")
            raise MeshFileError(named, error.code) from error
        if target == STREAM and file_written.exists():  # not in a dry run
            with file_written.open("rb") as file:
                shutil.copyfileobj(file, sys.stdout.buffer)
            sys.stdout.buffer.flush()
