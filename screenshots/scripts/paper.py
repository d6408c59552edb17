"""The figures of the paper, for any meshes: `paper.py MESH ... [--output DIR]`.

The paper is Kovnatsky, Bronstein, Bronstein: Stable Spectral Mesh Filtering, 2012.

1  a strong filter in one shot, and in ten fractional steps
4  eigenfunctions before a filter, after a tenth of it, and after all of it
5  the fractional powers of two filters, and the shapes they produce

Each mesh gets its own pictures, viewed along the shortest axis of its bounding box with y up, or z;
the numbers behind them are in numbers.json next to them.
The paper's meshes, the dragon and the angel (Lucy), are in the Stanford 3D Scanning Repository,
https://graphics.stanford.edu/data/3Dscanrep/.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import eigenfunctions
import sequences
import stability
from meshlab_spectral import SpectralError
from subject import Subject

FIGURES = {
    1: ("figure1_stability", stability.figure),
    4: ("figure4_eigenfunctions", eigenfunctions.figure),
    5: ("figure5_sequences", sequences.figure),
}


def _main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("meshes", metavar="MESH", nargs="+", type=Path)
    parser.add_argument("--output", metavar="DIR", type=Path, default=Path())
    parser.add_argument("--only", metavar="NUMBER", nargs="+", type=int, choices=FIGURES)
    parser.add_argument("--scale", type=float, default=1.0, help="1 fills a screen")
    wanted = parser.parse_args()
    wanted.output.mkdir(parents=True, exist_ok=True)
    try:
        for source in wanted.meshes:
            subject = Subject(source)
            for number in wanted.only or FIGURES:
                name, figure = FIGURES[number]
                picture = wanted.output / f"{name}_{subject.name}.png"
                figure(subject, wanted.scale).save(picture)
                print(picture)
    except SpectralError as error:
        sys.exit(f"Error: {error}")


if __name__ == "__main__":
    _main()
