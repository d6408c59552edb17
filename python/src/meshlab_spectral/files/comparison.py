"""Comparison of two meshes: what a filter, a repair or another scan has changed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import ArrayError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.files.meshes import in_scene, joined, load_parts
from meshlab_spectral.filters.arrays import lumped_areas, mesh_arrays
from meshlab_spectral.filters.representations import brief, line, table

Array = NDArray[np.float64]
Arrays = tuple[Array, NDArray[Any]]

PERCENTILES = (50, 90, 95, 99)
# Relative to the sum of the areas: what round-off leaves of the area vectors of a closed surface.
_CLOSED = 1e-9


@dataclass(frozen=True, eq=False)
class Deviation:
    """One kind of deviation: a number at each vertex of a mesh, and its statistics.

    Statistics are over the surface, weighted by the vertex areas: a finer mesh of the same surface
    has the same ones.

    Attributes
    ----------
    values
        n values, length units; 0 at vertices without faces.
    mean, rms
        Mean with sign, and root mean square, length units.
    percentiles
        Percent of the surface -> the magnitude that this share of it does not exceed.
    largest
        The value of largest magnitude, with its sign.
    vertex, position
        Where that is: vertex index, and its coordinates.
    """

    values: Array
    mean: float
    rms: float
    percentiles: dict[int, float]
    largest: float
    vertex: int
    position: tuple[float, float, float]

    @property
    def numbers(self) -> dict[str, Any]:
        """All but the values at the vertices, for JSON."""
        return {
            "mean": self.mean,
            "rms": self.rms,
            "percentiles": {str(share): value for share, value in self.percentiles.items()},
            "largest": self.largest,
            "vertex": self.vertex,
            "position": list(self.position),
        }

    def __repr__(self) -> str:
        return line(self)


@dataclass(frozen=True, eq=False)
class Comparison:
    """What differs between two meshes, a and b.

    Attributes
    ----------
    a, b
        The meshes: n x 3 coordinates, and m x 3 vertex indices of triangles.
    same_faces
        Whether b has the faces of a, so that each vertex has a displacement.
    deviations
        With the same faces: "displacement", the length of each vertex's; "normal", its part along
        the normal of a, positive outwards; "tangential", the length of its part along the surface.
        Otherwise the distances to the nearest point of the other mesh, at the vertices of a,
        "a_to_b", and of b, "b_to_a": positive where b is outside a.
    areas
        Of a and b, length units squared.
    volumes
        Of a and b, length units cubed; None unless both are closed.
    """

    a: Arrays
    b: Arrays
    same_faces: bool
    deviations: dict[str, Deviation]
    areas: tuple[float, float]
    volumes: tuple[float, float] | None

    @property
    def report(self) -> dict[str, Any]:
        """All numbers but those at the vertices, for JSON."""
        return {
            "same_faces": self.same_faces,
            "deviations": {name: one.numbers for name, one in self.deviations.items()},
            "area": list(self.areas),
            "volume": None if self.volumes is None else list(self.volumes),
        }

    def save(self, archive: Path) -> None:
        """Write what `report` leaves out, as an archive of NumPy."""
        values: dict[str, Any] = {name: one.values for name, one in self.deviations.items()}
        np.savez(archive, V=self.a[0], F=self.a[1], W=self.b[0], G=self.b[1], **values)

    @classmethod
    def from_report(cls, report: Mapping[str, Any], archive: Path | None) -> Comparison:
        """Return the comparison of a `report`; without meshes and values if there is no archive."""
        arrays = defaultdict[str, Array](lambda: np.zeros((0, 3)))
        if archive is not None:
            with np.load(archive) as saved:
                arrays.update({name: saved[name] for name in saved.files})
        deviations = {
            name: Deviation(
                **{**one, "percentiles": {int(p): x for p, x in one["percentiles"].items()}},
                values=arrays[name],
            )
            for name, one in report["deviations"].items()
        }
        meshes = (arrays["V"], arrays["F"]), (arrays["W"], arrays["G"])
        volumes = report["volume"] and tuple(report["volume"])
        return cls(*meshes, report["same_faces"], deviations, tuple(report["area"]), volumes)

    @property
    def signed(self) -> Array:
        """The signed deviation at the vertices of b, to colour b by."""
        return self.deviations["normal" if self.same_faces else "b_to_a"].values

    def __repr__(self) -> str:
        return f"Comparison({', '.join(f'{name}={value}' for name, value in self._rows())})"

    def _repr_html_(self) -> str:
        return table(self._rows())

    def _rows(self) -> list[tuple[str, str]]:
        numbers = {"same_faces": self.same_faces, "areas": self.areas, "volumes": self.volumes}
        rows = [(name, brief(value)) for name, value in numbers.items()]
        for name, one in self.deviations.items():
            of_one = {key: getattr(one, key) for key in ("mean", "rms", "percentiles", "largest")}
            rows += [(f"{name}_{key}", brief(value)) for key, value in of_one.items()]
        return rows


def compare(a: Any, b: Any) -> Comparison:
    """Compare two meshes: how far the surface of b is from that of a, and on which side.

    If b has the faces of a, as after any filter of this package, each vertex is compared with
    itself. Otherwise each vertex is compared with the nearest point of the other mesh, found by
    VTK. The sign is that of the nearest point's normal: faces must be oriented consistently.

    Parameters
    ----------
    a, b
        Mesh files, meshes as for `filter_mesh`, or tuples (vertices, faces).

    Returns
    -------
    Comparison

    Raises
    ------
    ArrayError
        When an array has the wrong shape or type, a coordinate is not finite, or no face has an
        area.
    MeshFileError
        When a file cannot be read.
    MissingPackageError
        When the faces differ and PyVista (extra `render`) is not installed.

    Examples
    --------
    >>> change = compare("scan.ply", "smooth.ply")
    >>> change.deviations["normal"].rms, change.deviations["normal"].largest
    """
    meshes = _arrays(a, "a"), _arrays(b, "b")
    (V, F), (W, G) = meshes
    same = V.shape == W.shape and np.array_equal(F, G)
    deviations = _displacements(V, W, F) if same else _distances(*meshes)
    closed = _is_closed(V, F) and _is_closed(W, G)
    return Comparison(
        *meshes,
        same,
        deviations,
        (float(lumped_areas(V, F).sum()), float(lumped_areas(W, G).sum())),
        (_volume(V, F), _volume(W, G)) if closed else None,
    )


def _arrays(mesh: Any, name: str) -> Arrays:
    if isinstance(mesh, str | Path):
        mesh = joined(in_scene(load_parts(Path(mesh))))
    V, F = mesh_arrays(*mesh) if isinstance(mesh, tuple) else mesh_arrays(mesh)
    if not np.isfinite(V).all():
        raise ArrayError(f"{name} has coordinates that are not finite: remove these vertices")
    if not lumped_areas(V, F).any():
        raise ArrayError(f"{name} has no face with an area: there is no surface to compare")
    return V, F


def _displacements(V: Array, W: Array, F: NDArray[Any]) -> dict[str, Deviation]:
    areas = lumped_areas(V, F)
    N = np.zeros_like(V)
    np.add.at(N, F, _area_vectors(V, F)[:, None, :])
    lengths = np.linalg.norm(N, axis=1, keepdims=True)
    N = np.divide(N, lengths, out=np.zeros_like(N), where=lengths > 0)
    moved = np.where(areas[:, None] > 0, W - V, 0.0)
    normal = (moved * N).sum(axis=1)
    parts = {
        "displacement": np.linalg.norm(moved, axis=1),
        "normal": normal,
        "tangential": np.linalg.norm(moved - normal[:, None] * N, axis=1),
    }
    return {name: _deviation(values, V, areas) for name, values in parts.items()}


def _distances(a: Arrays, b: Arrays) -> dict[str, Deviation]:
    check_extras("render")
    areas = [lumped_areas(*mesh) for mesh in (a, b)]
    # From b, a point of a is inside where b is outside a.
    to_b = np.where(areas[0] > 0, -_signed_distances(a[0], *b), 0.0)
    to_a = np.where(areas[1] > 0, _signed_distances(b[0], *a), 0.0)
    return {
        "a_to_b": _deviation(to_b, a[0], areas[0]),
        "b_to_a": _deviation(to_a, b[0], areas[1]),
    }


def _signed_distances(points: Array, V: Array, F: NDArray[Any]) -> Array:
    """Return the distances of points to a surface, positive on the side its normals point to."""
    import pyvista

    # At an edge VTK takes the normals of both faces; it needs them to share its vertices.
    X, index = np.unique(V, axis=0, return_inverse=True)
    G = index.reshape(-1)[F]
    G = G[np.linalg.norm(_area_vectors(X, G), axis=1) > 0]
    surface = pyvista.PolyData.from_regular_faces(X, G)
    measured = pyvista.PolyData(points).compute_implicit_distance(surface)
    return np.asarray(measured["implicit_distance"], dtype=np.float64)


def _deviation(values: Array, V: Array, areas: Array) -> Deviation:
    share = areas / areas.sum()
    size = np.abs(values)
    order = np.argsort(size)
    reached = np.cumsum(share[order])
    # The last vertex where round-off leaves the sum below 1.
    at = np.searchsorted(reached, np.array(PERCENTILES) / 100).clip(max=len(V) - 1)
    vertex = int(np.argmax(size))
    x, y, z = V[vertex].tolist()
    return Deviation(
        values,
        mean=float(share @ values),
        rms=float(np.sqrt(share @ values**2)),
        percentiles=dict(zip(PERCENTILES, size[order[at]].tolist(), strict=True)),
        largest=float(values[vertex]),
        vertex=vertex,
        position=(x, y, z),
    )


def _area_vectors(V: Array, F: NDArray[Any]) -> Array:
    a, b, c = (V[F[:, corner]] for corner in range(3))
    vectors: Array = np.cross(b - a, c - a) / 2
    return vectors


def _is_closed(V: Array, F: NDArray[Any]) -> bool:
    """Whether the area vectors sum to zero: then the volume does not depend on the origin."""
    vectors = _area_vectors(V, F)
    total = float(np.linalg.norm(vectors, axis=1).sum())
    return bool(np.linalg.norm(vectors.sum(axis=0)) <= _CLOSED * total)


def _volume(V: Array, F: NDArray[Any]) -> float:
    a, b, c = (V[F[:, corner]] - V.mean(axis=0) for corner in range(3))
    return float((a * np.cross(b, c)).sum() / 6)
