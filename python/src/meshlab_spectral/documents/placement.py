"""Placements: transforms from a mesh's own coordinates to those of its scene, and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshlab_spectral.documents.document import Array, Indices

IDENTITY: Array = np.eye(4)
_SAME_SCALE = 1e-6  # relative difference of singular values
_SINGULAR = 1e-9  # smallest over largest singular value


@dataclass(frozen=True)
class Placement:
    """An invertible affine transform.

    Attributes
    ----------
    matrix
        4 x 4, for column vectors.
    """

    matrix: Array

    def is_identity(self) -> bool:
        """Return whether it leaves every vertex where it is."""
        return np.array_equal(self.matrix, IDENTITY)

    def placed(self, own: Array) -> Array:
        """Return vertices of the mesh, n x 3, where they are placed."""
        if self.is_identity():
            return own
        with np.errstate(over="ignore", invalid="ignore"):
            result: Array = own @ self.matrix[:3, :3].T + self.matrix[:3, 3]
        return result

    def oriented(self, faces: Indices) -> Indices:
        """Return triangles, turned if the transform mirrors: their outside stays outside."""
        return faces[:, [0, 2, 1]] if np.linalg.det(self.matrix[:3, :3]) < 0 else faces

    def back(self, own: Array, placed: Array, moved: Array) -> Array:
        """Return the mesh's own vertices once its placed ones have moved.

        Vertices that have not moved keep their coordinates exactly.
        """
        if self.is_identity():
            return np.where(moved == placed, own, moved)
        moves = (moved != placed).any(axis=1)
        result = own.copy()
        result[moves] += (moved - placed)[moves] @ np.linalg.inv(self.matrix[:3, :3]).T
        return result


def placement_of(name: str, matrices: Sequence[Array], warnings: list[str]) -> Placement:
    """Return the first placement of a mesh, none for a mesh that is not placed.

    Parameters
    ----------
    name
        The mesh's name, for warnings.
    matrices
        Its placements, 4 x 4.
    warnings
        Where to tell that it cannot be placed, or has other sizes elsewhere.
    """
    if not matrices:
        return Placement(IDENTITY)
    scales = _scales(matrices)
    if scales[0, 2] <= _SINGULAR * scales[0, 0]:
        warnings.append(
            f"{name} is flattened by a transform of scale 0 where it is placed: it is filtered in "
            "the size that it has without transforms"
        )
        return Placement(IDENTITY)
    if (np.abs(scales - scales[0]) > _SAME_SCALE * scales[0]).any():
        warnings.append(
            f"{name} is placed several times at different scales: lengths are those of its first "
            "placement"
        )
    return Placement(matrices[0])


def same_scale(first: Array, second: Array) -> bool:
    """Return whether two transforms stretch alike."""
    if np.array_equal(first[:3, :3], second[:3, :3]):
        return True
    a, b = _scales([first, second])
    return not (np.abs(a - b) > _SAME_SCALE * a).any()


def _scales(matrices: Sequence[Array]) -> Array:
    """Singular values of the linear parts, descending; zeros for those that are not finite."""
    linear = np.stack(matrices)[:, :3, :3]
    linear = np.where(np.isfinite(linear).all(axis=(1, 2), keepdims=True), linear, 0.0)
    return np.asarray(np.linalg.svd(linear, compute_uv=False), dtype=np.float64)
