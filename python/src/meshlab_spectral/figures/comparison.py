"""A comparison of two meshes as a picture, and as a coloured mesh file."""

from __future__ import annotations

from pathlib import Path

from meshlab_spectral.figures.signed_mesh import draw_signed, write_signed
from meshlab_spectral.files.comparison import Comparison


def colour_extent(comparison: Comparison) -> float:
    """Return the deviation at full colour: all but a hundredth of the surface has less.

    If that is 0 it is the largest one, and 1 between equal meshes.
    """
    deviation = comparison.deviations["normal" if comparison.same_faces else "b_to_a"]
    return deviation.percentiles[99] or abs(deviation.largest) or 1.0


def draw_comparison(comparison: Comparison, path: Path, names: tuple[str, str]) -> None:
    """Draw both meshes, with their names, and the deviation of b to a .png file.

    Raises MeshFileError when `path` cannot be written.
    """
    meshes = [(name, *mesh) for name, mesh in zip(names, (comparison.a, comparison.b), strict=True)]
    caption = "red: outside"
    draw_signed(meshes, "deviation", comparison.signed, colour_extent(comparison), caption, path)


def write_comparison(comparison: Comparison, scratch: Path) -> None:
    """Write mesh b as .ply with the deviation as quality and in colours, for MeshLab."""
    write_signed(*comparison.b, comparison.signed, colour_extent(comparison), scratch)
