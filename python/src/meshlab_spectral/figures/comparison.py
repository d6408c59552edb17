"""A comparison of two meshes as a picture, and as a coloured mesh file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from meshlab_spectral.figures.sheet import Sheet
from meshlab_spectral.figures.signed_mesh import signed_sheet, write_signed
from meshlab_spectral.files.comparison import Comparison
from meshlab_spectral.filters.arrays import check_class

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_comparison(comparison: Comparison, path: Path, names: tuple[str, str]) -> None:
    """Draw both meshes, with their names, and the deviation of b to a .png file, atomically.

    Raises MeshFileError when `path` cannot be written.
    """
    _sheet(comparison, names).save(path)


def plot_comparison(comparison: Comparison, names: tuple[str, str] = ("a", "b")) -> Figure:
    """Show both meshes, and how far b is from a in colours: red outside, blue inside.

    All pictures have the same light and camera; the scale is in the units of the mesh.

    Parameters
    ----------
    comparison
        As from `compare`.
    names
        Labels of both meshes.

    Returns
    -------
    matplotlib.figure.Figure
        Not registered with pyplot: a notebook shows it as the value of a cell; ``savefig(path)``
        saves it.

    Raises
    ------
    MissingPackageError
        When PyVista (extra `render`) or Matplotlib (extra `plots`) is not installed.

    Examples
    --------
    >>> plot_comparison(compare("scan.ply", "smooth.ply"))
    """
    check_class(comparison, Comparison, "compare")
    return _sheet(comparison, names).figure


def _sheet(comparison: Comparison, names: tuple[str, str]) -> Sheet:
    meshes = [(name, *mesh) for name, mesh in zip(names, (comparison.a, comparison.b), strict=True)]
    extent = comparison.color_extent
    return signed_sheet(meshes, "deviation", comparison.signed, extent, "red: outside")


def write_comparison(comparison: Comparison, scratch: Path) -> None:
    """Write mesh b as .ply with the deviation as quality and in colours, for MeshLab."""
    write_signed(*comparison.b, comparison.signed, comparison.color_extent, scratch)
