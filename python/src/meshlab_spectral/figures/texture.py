"""The roughness of a surface as a picture, and as a coloured mesh file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import ArrayError
from meshlab_spectral.figures.sheet import Sheet
from meshlab_spectral.figures.signed_mesh import signed_sheet, write_signed
from meshlab_spectral.filters.arrays import check_class, mesh_arrays
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone
from meshlab_spectral.filters.texture import SurfaceTexture

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


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
    return _sheet(V, F, texture, name).figure


def draw_texture(V: Array, F: NDArray[Any], texture: SurfaceTexture, path: Path, name: str) -> None:
    """Draw the picture of `plot_texture` to a .png file, atomically.

    Raises MeshFileError when `path` cannot be written.
    """
    _sheet(V, F, texture, name).save(path)


def write_texture(V: Array, F: NDArray[Any], texture: SurfaceTexture, scratch: Path) -> None:
    """Write a mesh as .ply with the heights as quality and in colours, for MeshLab."""
    write_signed(V, F, texture.height, _extent(texture), scratch)


def _sheet(V: Array, F: NDArray[Any], texture: SurfaceTexture, name: str) -> Sheet:
    return signed_sheet([(name, V, F)], "roughness", texture.height, _extent(texture), "red: peaks")


def _extent(texture: SurfaceTexture) -> float:
    """Return the height at full colour."""
    return 3 * texture.Sq or 1.0
