"""The artefacts a filter leaves in a mesh, measured on NumPy arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral.errors import OptionError
from meshlab_spectral.filters.arrays import mesh_arrays
from meshlab_spectral.filters.mesh_objects import takes_mesh_alone
from meshlab_spectral.filters.options import LaplacianKind
from meshlab_spectral.filters.progress import Progress
from meshlab_spectral.filters.representations import line
from meshlab_spectral.filters.running import run

_FILTER_NAME = "compute_scalar_spectral_artefacts_per_vertex"


@dataclass(frozen=True, eq=False)
class Artefacts:
    """The part of a shape above twice the cutoff frequency, in the shape's own spectrum.

    Attributes
    ----------
    rms
        Root mean square of `length` over the surface, length units.
    maximum
        Largest `length`, length units.
    length
        Length of the artefact part at each of the n vertices, length units; 0 at unreferenced
        vertices.
    diagonal
        Bounding box diagonal of the measured mesh, length units. The filter may have changed it:
        to compare results, divide by the diagonal of the filter's input.
    """

    rms: float
    maximum: float
    length: NDArray[np.float64]
    diagonal: float

    def __repr__(self) -> str:
        return line(self)


@takes_mesh_alone
def measure_artefacts(
    vertices: Any,
    faces: ArrayLike | None,
    feature_size: str | float,
    laplacian: LaplacianKind = "intrinsic delaunay",
    *,
    progress: Progress | bool | None = None,
    threads: int | None = None,
) -> Artefacts:
    """Measure the artefacts a filter has left in a mesh: spikes, creases, ripples.

    With X the coordinates and A the Laplacian of the mesh itself, the artefact part is
    ``X - g(A) X``, ``g(lambda) = 1 / (1 + (lambda / (4 lambda_c))**4)`` with
    ``lambda_c = (2 pi / feature_size)**2``: everything above twice the cutoff frequency
    ``2 pi / feature_size``. It scales with the mesh and is invariant under rigid motion.

    Parameters
    ----------
    vertices, faces
        Coordinates and triangles, or a mesh, as for `filter_mesh`.
    feature_size
        Feature size of the applied low-pass or band, > 0: a length, or as "2%" of this mesh's
        diagonal, "6e" in its mean edges.
    laplacian
        "intrinsic delaunay" works with any triangles; "cotangent" needs non-degenerate ones;
        "uniform" uses the connectivity only.
    progress, threads
        As for `filter_mesh`.

    Returns
    -------
    Artefacts
        Root mean square, maximum and the length at every vertex, length units.

    Raises
    ------
    SpectralError
        As from `filter_mesh`: an OptionError when `feature_size` is not positive.

    Examples
    --------
    >>> before = mesh_set.current_mesh().bounding_box().diagonal()
    >>> mesh_set.apply_coord_spectral_filter_fractional(
    ...     feature_size=pymeshlab.PureValue(0.15 * before))
    >>> result = mesh_set.current_mesh()
    >>> left = measure_artefacts(result.vertex_matrix(), result.face_matrix(), 0.15 * before)
    >>> left.rms / before, left.maximum / before
    """
    V, F = mesh_arrays(vertices, faces)
    if feature_size == "auto":
        raise OptionError("feature_size = auto: give the size that was filtered with")
    parameters = {"feature_size": feature_size, "laplacian": laplacian}
    done = run(_FILTER_NAME, V, F, parameters, progress=progress, threads=threads)
    assert done.values is not None
    return Artefacts(
        rms=done.report["rms"],
        maximum=done.report["maximum"],
        length=done.values[:, 0],
        diagonal=done.report["diagonal"],
    )
