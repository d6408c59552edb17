"""Placements: transforms from a mesh's own coordinates to those of its scene, and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshlab_spectral.formats.document import Array, Indices
from meshlab_spectral.warned import Warned

IDENTITY: Array = np.eye(4)
_SAME_SCALE = 1e-6  # relative difference of singular values
_SINGULAR = 1e-9  # smallest over largest singular value


@dataclass(frozen=True)
class Placement:
    """An invertible affine transform, a 4 x 4 matrix for column vectors.

    `copies` are transforms from there to the mesh's other places in the scene.
    """

    matrix: Array
    copies: tuple[Array, ...] = ()

    def placed(self, own: Array) -> Array:
        """Transform vertices of the mesh, n x 3, to the scene."""
        with np.errstate(over="ignore", invalid="ignore"):
            result: Array = own @ self.matrix[:3, :3].T + self.matrix[:3, 3]
        return result

    def oriented(self, faces: Indices) -> Indices:
        """Return triangles, flipped if the transform mirrors, so that the outside stays outside."""
        return faces[:, [0, 2, 1]] if np.linalg.det(self.matrix[:3, :3]) < 0 else faces

    def back(self, own: Array, placed: Array, moved: Array) -> Array:
        """Return the mesh's own vertices after placed ones have moved; the others stay exact."""
        if np.array_equal(self.matrix, IDENTITY):
            return np.where(moved == placed, own, moved)
        moves = (moved != placed).any(axis=1)
        result = own.copy()
        result[moves] += (moved - placed)[moves] @ np.linalg.inv(self.matrix[:3, :3]).T
        return result


def placement_of(name: str, matrices: Sequence[Array] | Array, warnings: list[Warned]) -> Placement:
    """Return the first placement of a mesh, or the identity if it has none or a singular one.

    The others become its copies, if they are not singular and show the mesh somewhere else. Appends
    to `warnings` if the first is singular, or if others have another scale.
    """
    if not len(matrices):
        return Placement(IDENTITY)
    scales = _scales(np.asarray(matrices))
    is_flat = scales[:, 2] <= _SINGULAR * scales[:, 0]
    places = list(
        {m.tobytes(): m for m, flat in zip(matrices, is_flat, strict=True) if not flat}.values()
    )
    if is_flat[0]:
        warnings.append(
            Warned(
                "placement",
                f"{name} is flattened by a transform of scale 0 where it is placed: it is filtered "
                "in the size that it has without transforms",
            )
        )
        return Placement(IDENTITY, tuple(places))
    if (np.abs(scales[0] - scales) > _SAME_SCALE * scales[0]).any():
        warnings.append(
            Warned(
                "placement",
                f"{name} is placed several times at different scales: lengths are those of its "
                "first placement",
            )
        )
    back = np.linalg.inv(matrices[0])
    return Placement(matrices[0], tuple(matrix @ back for matrix in places[1:]))


def _scales(matrices: Array) -> Array:
    """Return the singular values of linear parts, k x 3, descending; zeros if one is not finite."""
    linear = matrices[:, :3, :3]
    linear = np.where(np.isfinite(linear).all(axis=(1, 2), keepdims=True), linear, 0.0)
    return np.asarray(np.linalg.svd(linear, compute_uv=False), dtype=np.float64)
