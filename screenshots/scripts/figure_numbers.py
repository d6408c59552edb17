"""The numbers behind pictures: recorded next to them when they are drawn, compared by a test.

`numbers.json` in a folder of pictures has the numbers of each: how far shapes have moved, what
artefacts are left, wavelengths, angles. Lengths are in percent of the bounding box diagonal of the
mesh before the filter.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from math import isclose
from pathlib import Path
from typing import Any

import numpy as np
from meshlab_spectral.files.whole_files import writing_whole
from meshlab_spectral.filters.arrays import lumped_areas
from numpy.typing import NDArray

Numbers = dict[str, float]
# From a name such as dragon_40k.ply to the file.
MeshFile = Callable[[str], Path]

FILE = "numbers.json"
# Nobody sees 2 % less displacement in a picture; rounding to three digits changes up to 0.5 %.
TOLERANCE = 0.02
# 0.0001 % of the diagonal is a thousandth of a pixel.
NEGLIGIBLE = 1e-4


@dataclass(frozen=True)
class Drawing:
    """A picture that is computed, but not drawn yet.

    Attributes
    ----------
    numbers
        The numbers behind the picture.
    draw
        Draws it into a .png file.
    """

    numbers: Numbers
    draw: Callable[[Path], None]

    def save(self, path: Path) -> None:
        """Draw the picture, and record its numbers."""
        self.draw(path)
        record(path, self.numbers)


def diagonal(V: NDArray[Any]) -> float:
    """Return the diagonal of the bounding box."""
    return float(np.linalg.norm(np.ptp(V, axis=0)))


def displacement(V: NDArray[Any], F: NDArray[Any], Y: NDArray[Any]) -> Numbers:
    """Measure how far a filter has moved V to Y: root mean square over the surface, and largest."""
    distance = 100 / diagonal(V) * np.linalg.norm(Y - V, axis=1)
    rms = np.sqrt(np.average(distance**2, weights=lumped_areas(V, F)))
    return {"rms displacement, %": float(rms), "largest displacement, %": float(distance.max())}


def labelled(label: str, numbers: Numbers) -> Numbers:
    """Say which of the shapes in a picture these are the numbers of."""
    return {f"{label}: {name}": number for name, number in numbers.items()}


def recorded(folder: Path) -> dict[str, Numbers]:
    """Read the numbers of the pictures in a folder, by the pictures' file names."""
    path = folder / FILE
    numbers: dict[str, Numbers] = {}
    if path.exists():
        numbers = json.loads(path.read_text(encoding="utf-8"))
    return numbers


def record(picture: Path, numbers: Numbers) -> None:
    """Record the numbers of a picture, to three digits, in its folder."""
    rounded = {name: float(f"{number:.3g}") for name, number in numbers.items()}
    everything = recorded(picture.parent) | {picture.name: rounded}
    text = json.dumps(dict(sorted(everything.items())), indent=2, ensure_ascii=False)
    with writing_whole(picture.with_name(FILE)) as scratch:
        scratch.write_text(text + "\n", encoding="utf-8")


def differences(before: Numbers, now: Numbers) -> list[str]:
    """Compare recorded with computed numbers; return a line for each that differs visibly."""
    lines = []
    for name in sorted(before.keys() | now.keys()):
        a, b = before.get(name), now.get(name)
        if a is None or b is None or not isclose(a, b, rel_tol=TOLERANCE, abs_tol=NEGLIGIBLE):
            was, is_now = ("none" if x is None else f"{x:.3g}" for x in (a, b))
            lines.append(f"{name}: recorded {was}, now {is_now}")
    return lines
