"""Manifold harmonics of a mesh file, as a NumPy archive."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from meshlab_spectral.files.meshes import StageCallback, load_arrays
from meshlab_spectral.filters.harmonics import compute
from meshlab_spectral.filters.options import BasisOptions


def basis_to_scratch(
    source: Path,
    scratch: Path,
    options: BasisOptions,
    on_stage: StageCallback,
    mesh: str | None = None,
) -> dict[str, Any]:
    """Write the harmonics of a mesh file to a NumPy archive, `scratch` from `writing_whole`.

    Uses all meshes of the file as one, or only the one named `mesh`. Returns the sizes n and
    k as "vertices" and "harmonics". Errors are those of `harmonics.manifold_harmonics`, and
    MeshFileError when `source` cannot be read.

    The arrays are eigenvalues (k), frequencies (k), harmonics (n x k) and masses (n) as in
    `Harmonics`, and the mesh as read, to whose vertices the rows belong: vertices (n x 3), faces
    (m x 3).
    """
    on_stage("reading", None)
    V, F = load_arrays(source, mesh)
    on_stage("computing", None)
    basis = compute(V, F, options, progress=on_stage)
    on_stage("writing", None)
    with scratch.open("wb") as file:
        np.savez(
            file,
            eigenvalues=basis.eigenvalues,
            frequencies=basis.frequencies,
            harmonics=basis.harmonics,
            masses=basis.masses,
            vertices=V,
            faces=F,
        )
    return {"vertices": len(V), "harmonics": len(basis.eigenvalues)}
