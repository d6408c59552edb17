"""Every picture in screenshots/ but those of MeshLab: `draw.py MESHES PICTURES [NAME ...]`.

Draws the named pictures, or all, into the folder PICTURES, from meshes in the folder MESHES, and
records the numbers behind them there in numbers.json. tests/benchmarks must be on Python's path:
`make screenshots` does it all, and takes the pictures of MeshLab as well.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from pathlib import Path

import demo
import denoising
import measures
import parts
from figure_numbers import Drawing, MeshFile
from meshlab_spectral import SpectralError
from paper import FIGURES
from subject import Subject, subject_of

# The meshes of the paper.
PAPER = ("dragon_40k.ply", "angel_50k.ply")


def _figure(figure: Callable[[Subject], Drawing], name: str, mesh: MeshFile) -> Drawing:
    return figure(subject_of(mesh(name)))


PICTURES: dict[str, Callable[[MeshFile], Drawing]] = {
    "bunny_before_after": demo.before_and_after,
    **denoising.PICTURES,
    **parts.PICTURES,
    **measures.PICTURES,
    **{
        f"{name}_{Path(mesh).stem}": functools.partial(_figure, figure, mesh)
        for name, figure in FIGURES.values()
        for mesh in PAPER
    },
}


def _main() -> None:
    if len(sys.argv) < 3 or not PICTURES.keys() >= set(sys.argv[3:]):
        sys.exit(f"{__doc__}\nNames: {', '.join(PICTURES)}")
    meshes, folder = Path(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    try:
        for name in sys.argv[3:] or PICTURES:
            picture = folder / f"{name}.png"
            PICTURES[name](meshes.joinpath).save(picture)
            print(picture, flush=True)
    except SpectralError as error:
        sys.exit(f"Error: {error}")


if __name__ == "__main__":
    _main()
