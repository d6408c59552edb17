"""The Laplacian of a mesh, as sparse matrices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshlab_spectral import _core
from meshlab_spectral.errors import OptionError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.filters.arrays import mesh_arrays
from meshlab_spectral.filters.options import LaplacianKind
from meshlab_spectral.filters.progress import Progress, progress_callback
from meshlab_spectral.filters.running import thread_count

if TYPE_CHECKING:
    import scipy.sparse


def laplacian(
    mesh_or_vertices: Any,
    faces: ArrayLike | None = None,
    *,
    kind: LaplacianKind = "intrinsic delaunay",
    progress: Progress | bool | None = None,
    threads: int | None = None,
) -> tuple[scipy.sparse.csr_matrix, NDArray[np.float64]]:
    """Compute the stiffness matrix W and the masses D of a mesh, with ``W phi = lambda D phi``.

    The Laplacian is D^-1 W; W is positive semidefinite, and its rows sum to 0: its constants are
    those of the connected components (Kovnatsky et al. 2012, Eq. 4, with the opposite sign).

    Parameters
    ----------
    mesh_or_vertices, faces
        As for `filter_mesh`.
    kind
        "intrinsic delaunay": that of the tufted cover (Sharp and Crane 2020), for any triangles;
        "cotangent": the paper's, for triangles with an area; "uniform": the connectivity only.
    progress, threads
        As for `filter_mesh`.

    Returns
    -------
    W : scipy.sparse.csr_matrix
        n x n, symmetric, dimensionless; empty rows at vertices without faces, and at copies of a
        vertex along a seam, of which the first stands for all.
    D : array
        n masses, length^2, a third of the area of the incident triangles (uniform: their mean); 0
        where the rows of W are empty.

    Raises
    ------
    SpectralError
        As from `filter_mesh`: an OptionError when `kind` is unknown.
    MissingPackageError
        When scipy is not installed.

    Examples
    --------
    >>> W, D = laplacian(vertices, faces)
    >>> heat = scipy.sparse.linalg.spsolve(scipy.sparse.diags(D) + t * W, D * source)
    """
    check_extras("matrices")
    import scipy.sparse

    kinds = get_args(LaplacianKind)
    if kind not in kinds:
        raise OptionError(f"kind = {kind}: choose {', '.join(kinds)}")
    V, F = mesh_arrays(mesh_or_vertices, faces)
    with progress_callback(progress) as on_progress:
        data, columns, offsets, masses, vertex = _core.laplacian(
            V, F, kinds.index(kind), progress=on_progress, threads=thread_count(threads)
        )
    rows = np.repeat(vertex, np.diff(offsets))
    W = scipy.sparse.csr_matrix((data, (rows, vertex[columns])), shape=(len(V), len(V)))
    D = np.zeros(len(V))
    D[vertex] = masses
    return W, D
