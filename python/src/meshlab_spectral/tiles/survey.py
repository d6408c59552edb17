"""What a filter needs to know about the whole mesh: passes over its points and its faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshlab_spectral.errors import MeshFileError
from meshlab_spectral.filters.arrays import Lengths
from meshlab_spectral.filters.progress import StageCallback
from meshlab_spectral.formats.document import Array
from meshlab_spectral.formats.rows import MeshRows, chunks
from meshlab_spectral.tiles.missing_data import Sides

_SAMPLE = 400_000  # points, at most, by which the cells are chosen


@dataclass(frozen=True)
class Survey:
    """The lengths of a mesh, points at random places of it, and whether any part is selected."""

    lengths: Lengths
    sample: Array
    has_selection: bool


def survey(mesh: MeshRows, on_progress: StageCallback) -> Survey:
    """Measure a mesh; raises MeshFileError when a coordinate is not finite or a face is invalid."""
    box, surface, sides, sample, has_selection = _Box(), _Box(), Sides(), [], False
    if not mesh.is_joined_by_position:
        for i, j in chunks(mesh.points):
            box.add(_finite(mesh, mesh.columns(slice(i, j))))
            if mesh.flags[0]:
                has_selection |= bool(mesh.selected(slice(i, j)).any())
            mesh.forget()
    share = min(1.0, _SAMPLE / mesh.faces)
    for i, j in chunks(mesh.faces):
        on_progress("measuring the mesh", i / mesh.faces)
        X = [_finite(mesh, one) for one in mesh.corners_of(mesh.triangles(i, j))]
        for k, corners in enumerate(X):
            surface.add(corners)
            sides.add(np.linalg.norm(corners - X[k - 1], axis=1))
        chosen = np.random.default_rng(i).integers(0, j - i, max(1, int(share * (j - i))))
        sample.append(X[0][chosen])
        if mesh.flags[1]:
            has_selection |= bool(mesh.selected_faces(i, j).any())
        mesh.forget()
    diagonal = surface.diagonal if mesh.is_joined_by_position else box.diagonal
    edge, low, high = sides.without_missing(mesh, surface.low, surface.high)
    lengths = Lengths(diagonal, edge, float(np.linalg.norm(high - low)))
    return Survey(lengths, np.vstack(sample), has_selection)


class _Box:
    def __init__(self) -> None:
        self.low, self.high = np.full(3, np.inf), np.full(3, -np.inf)

    def add(self, points: Array) -> None:
        if len(points):
            self.low = np.minimum(self.low, points.min(axis=0))
            self.high = np.maximum(self.high, points.max(axis=0))

    @property
    def diagonal(self) -> float:
        return float(np.linalg.norm(self.high - self.low))


def _finite(mesh: MeshRows, points: Array) -> Array:
    if not np.isfinite(points).all():
        raise MeshFileError(f"{mesh.path} has coordinates that are not finite", "bad_values")
    return points
