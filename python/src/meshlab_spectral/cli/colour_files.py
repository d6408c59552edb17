"""The files of commands that colour a mesh by a signed number: `--output` and `--picture`."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from meshlab_spectral.errors import OptionError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.files.extensions import check_ending
from meshlab_spectral.files.whole_files import check_target, writing_whole

_PICTURE = typer.Option(
    metavar="FILE", help="Draw a .png picture: the meshes, and the result in colours."
)
Picture = Annotated[Path | None, _PICTURE]
Overwrite = Annotated[
    bool,
    typer.Option("--overwrite", "--force", "-f", help="Replace files that exist."),
]


def coloured_mesh(what: str) -> typer.models.OptionInfo:
    """Return the option `--output`; `what` says which number, and what red and blue mean."""
    text = f"Write the mesh as .ply with {what}."
    option: typer.models.OptionInfo = typer.Option("--output", "-o", metavar="FILE", help=text)
    return option


def check_picture(picture: Path | None, overwrite: bool) -> None:
    """Raise, before any work, what would prevent a picture: its name, its folder, an extra."""
    if picture is not None:
        check_extras("plots", "render")
        check_ending(picture, "the picture is a PNG file", ".png")
        refuse_existing(picture, overwrite)
        check_target(picture)


def refuse_existing(output: Path | None, overwrite: bool) -> None:
    """Raise OptionError for an output that exists, unless the user wants it replaced."""
    if output is not None and output.is_file() and not overwrite:
        raise OptionError(f"{output} exists: choose another name, or replace it with --overwrite")


@contextlib.contextmanager
def writing_coloured(
    output: Path | None, picture: Path | None, overwrite: bool, *inputs: Path
) -> Iterator[Path | None]:
    """Check both files; yield the scratch file of `output`, if any, which it becomes at the end."""
    for source in inputs:
        if output is not None and output.exists() and source.exists() and output.samefile(source):
            raise OptionError(f"{output} is an input itself and would be lost: choose another name")
    refuse_existing(output, overwrite)
    check_picture(picture, overwrite)
    if output is None:
        yield None
        return
    check_ending(output, "a mesh with colours and quality is a PLY file", ".ply")
    with writing_whole(output) as scratch:
        yield scratch
