"""The command `meshlab-spectral figures`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meshlab_spectral.cli.messages import errors_reported, print_result
from meshlab_spectral.cli.progress import progress_shown
from meshlab_spectral.figures.paper import FIGURES, draw_figures

# "\b" keeps a paragraph's lines as they are.
FIGURES_HELP = """Draw the figures of the paper from your meshes.

The paper is Kovnatsky, Bronstein, Bronstein: Stable Spectral Mesh Filtering, 2012.

\b
1  a strong filter in one shot, and in ten fractional steps
4  eigenfunctions before a filter, after a tenth of it, and after all of it
5  the fractional powers of two filters, and the shapes they produce

Each mesh gets its own pictures. The paper's meshes, the dragon and the angel, are in the Stanford
3D Scanning Repository, https://graphics.stanford.edu/data/3Dscanrep/.

\b
  meshlab-spectral figures dragon.ply angel.ply --output pictures
  meshlab-spectral figures scan.ply --only 1,5
"""


def figures_command(
    meshes: Annotated[
        list[Path],
        typer.Argument(
            metavar="MESH", help="Meshes to show, viewed along their shortest axis with y up, or z."
        ),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="DIR", help="Folder for the pictures, created if needed."
        ),
    ] = Path(),
    only: Annotated[
        str, typer.Option(metavar="NUMBERS", help="Figures to draw, such as 1,5.")
    ] = ",".join(map(str, FIGURES)),
    scale: Annotated[
        float, typer.Option(min=0.1, max=10, help="Resolution: 2 doubles the pixels per side.")
    ] = 1.0,
) -> None:
    """Draw the figures of the paper: see `meshlab-spectral figures --help`."""
    numbers = _figure_numbers(only)
    interrupted = "finished pictures are complete"
    with errors_reported(interrupted), progress_shown() as on_progress:
        pictures = draw_figures(
            meshes, output, numbers, scale, lambda stage: on_progress(stage, None)
        )
    for picture in pictures:
        print_result(picture)


def _figure_numbers(text: str) -> list[int]:
    known = {str(number): number for number in FIGURES}
    numbers = [part.strip() for part in text.split(",")]
    if not known.keys() >= set(numbers):
        raise typer.BadParameter(f"{text!r}: choose from {', '.join(known)}", param_hint="--only")
    return [known[number] for number in numbers]
