"""Pictures and mesh files of a signed number at each vertex: deviations, and heights."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import ArrayError
from meshlab_spectral.figures.pictures import Frame, Panel, View, render
from meshlab_spectral.figures.sheet import Sheet
from meshlab_spectral.files.comparison import Comparison, signed_colours
from meshlab_spectral.filters.arrays import check_class, mesh_arrays
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone
from meshlab_spectral.filters.texture import SurfaceTexture
from meshlab_spectral.formats.ply_elements import write_ply

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


def signed_sheet(
    meshes: Sequence[tuple[str, Array, NDArray[Any]]],
    label: str,
    values: Array,
    extent: float,
    caption: str,
) -> Sheet:
    """Draw meshes, and the last of them again in colours.

    All have the same light and camera. `meshes` are labels, coordinates and triangles; `label` is
    that of the coloured picture, `values` are those at the vertices of the last mesh. Colours are
    blue, grey and red for -extent, 0 and extent; `caption` says what that means.
    """
    panels = [Panel(name, V, F.astype(np.int64)) for name, V, F in meshes]
    last = panels[-1]
    share = np.clip(values / extent, -1, 1)
    panels.append(Panel(label, last.V, last.F, share, zero_line=False))
    frame = Frame.around([panel.V for panel in panels], View.of_widest_side(last.V))
    sheet = Sheet([frame.width / frame.height], len(panels), 1, footer=0.56)
    for column, panel in enumerate(panels):
        sheet.picture(0, column, render(panel, frame, sheet.pixels), panel.label)
    labels = (f"\N{MINUS SIGN}{extent:.3g}", "0", f"{extent:.3g}")
    sheet.colour_bar(labels, f"{caption}, in the units of the mesh")
    return sheet


def write_signed(V: Array, F: NDArray[Any], values: Array, extent: float, scratch: Path) -> None:
    """Write a mesh as .ply: blue, white and red are -extent, 0 and extent, as in MeshLab."""
    colours = dict(zip(("red", "green", "blue"), signed_colours(values, extent).T, strict=True))
    write_ply(scratch, V, F, quality=values, **colours)


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
    return comparison_sheet(comparison, names).figure


def comparison_sheet(comparison: Comparison, names: tuple[str, str]) -> Sheet:
    """Draw both meshes, with their names, and the deviation of b."""
    meshes = [(name, *mesh) for name, mesh in zip(names, (comparison.a, comparison.b), strict=True)]
    extent = comparison.color_extent
    return signed_sheet(meshes, "deviation", comparison.signed, extent, "red: outside")


@takes_mesh_alone
def plot_texture(
    mesh_or_vertices: Any,
    faces: ArrayLike | None,
    texture: SurfaceTexture,
    name: str = "surface",
) -> Figure:
    """Show a mesh, and its heights above the reference in colours: red peaks, blue valleys.

    Grey is at the reference, or left out. Colours are full at three Sq.

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `surface_texture`.
    texture
        Texture of this mesh, as from `surface_texture`.
    name
        Label of the mesh.

    Returns
    -------
    matplotlib.figure.Figure
        As of `plot_comparison`.

    Raises
    ------
    ArrayError
        When an array of the mesh has the wrong shape or type, or the texture belongs to a mesh with
        another number of vertices.
    MissingPackageError
        When PyVista (extra `render`) or Matplotlib (extra `plots`) is not installed.

    Examples
    --------
    >>> plot_texture(V, F, surface_texture(V, F, waviness=0.8))
    """
    check_class(texture, SurfaceTexture, "surface_texture")
    V, F = mesh_arrays(mesh_or_vertices, faces)
    if len(texture.height) != len(V):
        raise ArrayError(
            f"the texture is of a mesh of {len(texture.height)} vertices, not of {len(V)}: "
            "pass that of this mesh"
        )
    return texture_sheet(V, F, texture, name).figure


def texture_sheet(V: Array, F: NDArray[Any], texture: SurfaceTexture, name: str) -> Sheet:
    """Draw the picture of `plot_texture`."""
    extent = full_height(texture)
    return signed_sheet([(name, V, F)], "roughness", texture.height, extent, "red: peaks")


def full_height(texture: SurfaceTexture) -> float:
    """Return the height at full colour."""
    return 3 * texture.Sq or 1.0
