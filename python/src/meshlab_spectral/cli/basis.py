"""The command `meshlab-spectral basis`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from meshlab_spectral.cli.colour_files import Overwrite, check_picture, refuse_existing
from meshlab_spectral.cli.filter_options import OneMesh, Source, with_options
from meshlab_spectral.cli.messages import errors_reported, print_result
from meshlab_spectral.cli.progress import progress_shown
from meshlab_spectral.figures.harmonics import check_modes, draw_basis_file
from meshlab_spectral.files.extensions import check_ending
from meshlab_spectral.files.request import Request
from meshlab_spectral.filters.options import BasisOptions
from meshlab_spectral.workers.single_file import write_in_child


@with_options(BasisOptions)
def basis_command(
    explicit: dict[str, Any],
    source: Source,
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="NumPy archive to write.",
        ),
    ] = Path("basis.npz"),
    mesh: OneMesh = None,
    pictures: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Sheet of pictures to draw, a .png file.")
    ] = None,
    modes: Annotated[
        str | None, typer.Option(metavar="NUMBERS", help="Harmonics to draw, such as 1,2,3,5,8.")
    ] = None,
    scale: Annotated[
        float, typer.Option(min=0.1, max=10, help="Resolution of the pictures; 1 fills a screen.")
    ] = 1.0,
    overwrite: Overwrite = False,
) -> None:
    """Compute manifold harmonics, as arrays and pictures.

    The output is a NumPy archive with the arrays eigenvalues (k), frequencies (k, their square
    roots), harmonics (n x k), masses (n, the vertex areas: with these as weights the harmonics are
    orthonormal), and the mesh that their rows belong to, vertices (n x 3) and faces (m x 3).

      meshlab-spectral basis scan.ply --basis-size 200 --output scan.npz
      meshlab-spectral basis scan.ply --pictures scan.png --modes 1,2,3,5,8
    """
    with errors_reported("finished files are complete"):
        options = BasisOptions.from_dict(explicit)
        shown = None if modes is None else _modes(modes, options.basis_size)
        check_ending(output, "a basis is a NumPy archive", ".npz")
        refuse_existing(output, overwrite)
        check_picture(pictures, overwrite)
        with progress_shown() as on_progress:
            write_in_child("basis_to_scratch", Request(source, options, mesh), output, on_progress)
            if pictures is not None:
                on_progress("drawing", None)
                draw_basis_file(output, pictures, shown, scale)
    for path in (output, pictures):
        if path is not None:
            print_result(path)


def _modes(text: str, basis_size: int) -> list[int]:
    try:
        modes = [int(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(
            f"{text!r}: give numbers such as 1,2,3,5,8", param_hint="--modes"
        ) from None
    check_modes(modes, basis_size)
    return modes
