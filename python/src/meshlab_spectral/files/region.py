"""Which region of a mesh a command filters: options that are no property of the file."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.option_types import option


@dataclass(frozen=True, kw_only=True)
class Region:
    """The vertices for which all that is given holds; around them, the effect fades out."""

    box: str | None = option(
        None,
        "Only inside a box, X,Y,Z,X,Y,Z: two opposite corners, in the units of the file; "
        "inf and -inf are no limit.",
        metavar="BOX",
    )
    component: str | None = option(
        None,
        "Only the largest connected component, or the one of this number: 1 is the largest "
        "by area, 2 the next, over all meshes of the file.",
        metavar="largest|N",
    )
    where: str | None = option(
        None,
        "Only where a condition holds, such as 'z > 3 && nz > 0', of the position x, y, z, "
        "the vertex normal nx, ny, nz and the quality q.",
        metavar="CONDITION",
    )
    mask: Path | None = option(
        None,
        "Only the vertices that are not 0 in a file with one number for each, text or .npy.",
        metavar="FILE",
    )

    def __post_init__(self) -> None:
        if self.mask is not None:
            object.__setattr__(self, "mask", self.mask.absolute())  # frozen for everybody else
        if self.box is not None:
            self.corners()
        if self.component not in (None, "largest") and not self.number:
            raise OptionError(f"component = {self.component}: give largest, or a number from 1")

    def corners(self) -> list[float]:
        """Return the six numbers of the box; raise OptionError unless there are as many."""
        try:
            numbers = [float(number) for number in str(self.box).split(",")]
        except ValueError:
            numbers = []
        if len(numbers) != 6 or any(number != number for number in numbers):
            raise OptionError(f"box = {self.box}: give six numbers, such as 0,0,0,1,1,inf")
        return numbers

    @property
    def number(self) -> int:
        """The number of the component, from 1; 0 if that is none."""
        if self.component == "largest":
            return 1
        text = self.component or ""
        return int(text) if text.isascii() and text.isdecimal() else 0

    def __bool__(self) -> bool:
        return bool(self.given())

    def given(self) -> dict[str, Any]:
        """Return what is given, as plain values; empty for the whole mesh."""
        return {
            name: str(value) if isinstance(value, Path) else value
            for name, value in asdict(self).items()
            if value is not None
        }
