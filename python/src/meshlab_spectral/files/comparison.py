"""Comparison of two meshes: what a filter, a repair or another scan has changed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral.errors import ArrayError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.files.meshes import in_scene, load_parts
from meshlab_spectral.filters.arrays import lumped_areas, mesh_arrays
from meshlab_spectral.filters.representations import brief, line, table
from meshlab_spectral.formats.document import joined
from meshlab_spectral.formats.normals import area_vectors, vertex_normals
from meshlab_spectral.warned import Warned, with_warnings

Array = NDArray[np.float64]
Arrays = tuple[Array, NDArray[Any]]

PERCENTILES = (50, 90, 95, 99)
# Relative to the sum of the areas: what round-off leaves of the area vectors of a closed surface.
_CLOSED = 1e-9
_AT_RIM = 1e-6  # of the diagonal
_ABOVE = 0.866  # cosine of 30 degrees: the distance is at most 15 % more than across the surface
# Of lengths in other units: mm in cm, in inches, in 0.1 m, in m.
_FACTORS = (10.0, 25.4, 100.0, 1000.0)
_SAME_SIZE = 0.02  # scans of one object differ by as much


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
        percentiles = {str(share): value for share, value in self.percentiles.items()}
        numbers = vars(self) | {"percentiles": percentiles, "position": list(self.position)}
        del numbers["values"]
        return numbers

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
    beyond
        The share of the surface of each mesh, by the names of `deviations`, whose nearest point is
        on the rim of the other, or farther than the greatest distance: not in the statistics.
    warnings
        What the numbers may be due to: other units, or no common part.
    """

    a: Arrays
    b: Arrays
    same_faces: bool
    deviations: dict[str, Deviation]
    areas: tuple[float, float]
    volumes: tuple[float, float] | None
    beyond: dict[str, float] = field(default_factory=dict)
    warnings: list[Warned] = field(default_factory=list)

    @property
    def report(self) -> dict[str, Any]:
        """All numbers but those at the vertices, for JSON."""
        numbers = {
            "same_faces": self.same_faces,
            "deviations": {name: one.numbers for name, one in self.deviations.items()},
            "area": list(self.areas),
            "volume": None if self.volumes is None else list(self.volumes),
            "beyond": self.beyond,
        }
        return with_warnings(numbers, self.warnings)

    @property
    def without_arrays(self) -> Comparison:
        """The same without the meshes, and the values at their vertices."""
        none = np.zeros((0, 3))
        deviations = {name: replace(one, values=none) for name, one in self.deviations.items()}
        return replace(self, a=(none, none), b=(none, none), deviations=deviations)

    @property
    def _signed(self) -> Deviation:
        return self.deviations["normal" if self.same_faces else "b_to_a"]

    @property
    def signed(self) -> Array:
        """The signed deviation at the vertices of b, to colour b by."""
        return self._signed.values

    @property
    def color_extent(self) -> float:
        """The deviation at full colour, length units: all but a hundredth of the surface has less.

        If that is 0 it is the largest one, and 1 between equal meshes.
        """
        return self._signed.percentiles[99] or abs(self._signed.largest) or 1.0

    @property
    def colors(self) -> NDArray[np.uint8]:
        """Red, green and blue at the vertices of b, n x 3: red outside a, blue inside, white on it.

        `color_extent` and more are full red or blue.
        """
        return signed_colours(self.signed, self.color_extent)

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


def signed_colours(values: Array, extent: float) -> NDArray[np.uint8]:
    """Return red, green and blue, n x 3: -extent is blue, 0 white and extent red, as in MeshLab."""
    share = values / extent
    fade = 1 - np.minimum(np.abs(share), 1)
    rgb = np.column_stack([np.where(share > 0, 1, fade), fade, np.where(share < 0, 1, fade)])
    levels: NDArray[np.uint8] = np.round(255 * rgb).astype(np.uint8)
    return levels


def compare(a: Any, b: Any, *, max_distance: float | None = None) -> Comparison:
    """Compare two meshes: how far the surface of b is from that of a, and on which side.

    If b has the faces of a, as after any filter of this package, each vertex is compared with
    itself. Otherwise each vertex is compared with the nearest point of the other mesh, found by
    VTK. The sign is that of the nearest point's normal: faces must be oriented consistently. Where
    that point is on the rim of the other mesh, as between scans that overlap in part, the distance
    says nothing of either: such vertices are counted apart.

    Parameters
    ----------
    a, b
        Mesh files, meshes as for `filter_mesh`, or tuples (vertices, faces).
    max_distance
        Vertices farther than that from the other mesh are counted apart, too, length units.

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
    if same:
        deviations, beyond = _displacements(V, W, F), dict[str, float]()
    else:
        deviations, beyond = _distances(*meshes, max_distance)
    closed = _is_closed(V, F) and _is_closed(W, G)
    return Comparison(
        *meshes,
        same,
        deviations,
        (float(lumped_areas(V, F).sum()), float(lumped_areas(W, G).sum())),
        (_volume(V, F), _volume(W, G)) if closed else None,
        beyond,
        _warnings(V[np.unique(F)], W[np.unique(G)], beyond),
    )


def _warnings(V: Array, W: Array, beyond: dict[str, float]) -> list[Warned]:
    """Return what the numbers may be due to."""
    sizes = [float(np.linalg.norm(np.ptp(points, axis=0))) for points in (V, W)]
    ratio = max(sizes) / min(sizes)
    found = []
    for factor in _FACTORS:
        if abs(ratio / factor - 1) < _SAME_SIZE:
            larger, smaller = ("a", "b") if sizes[0] > sizes[1] else ("b", "a")
            text = f"{larger} is {factor:g} times as large as {smaller}: are the units equal?"
            found.append(Warned("unequal_sizes", text))
    found += [
        Warned(
            "beyond_rim",
            f"{share:.1%} of the surface of {name[0]} lies beyond the rim of the other, or too "
            "far away, and is left out",
        )
        for name, share in beyond.items()
        if share > 0
    ]
    return found


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
    N = vertex_normals(V, F)
    moved = np.where(areas[:, None] > 0, W - V, 0.0)
    normal = (moved * N).sum(axis=1)
    parts = {
        "displacement": np.linalg.norm(moved, axis=1),
        "normal": normal,
        "tangential": np.linalg.norm(moved - normal[:, None] * N, axis=1),
    }
    return {name: _deviation(values, V, areas) for name, values in parts.items()}


def _distances(
    a: Arrays, b: Arrays, most: float | None
) -> tuple[dict[str, Deviation], dict[str, float]]:
    check_extras("render")
    areas = [lumped_areas(*mesh) for mesh in (a, b)]
    # From b, a point of a is inside where b is outside a.
    to_b, beyond_b = _signed_distances(a[0], *b, most)
    to_a, beyond_a = _signed_distances(b[0], *a, most)
    deviations, beyond = dict[str, Deviation](), dict[str, float]()
    for name, distances, is_beyond, (points, _), area in (
        ("a_to_b", -to_b, beyond_b, a, areas[0]),
        ("b_to_a", to_a, beyond_a, b, areas[1]),
    ):
        counted = area * ~is_beyond
        beyond[name] = 1 - float(counted.sum() / area.sum())
        if not counted.any():  # no common part
            counted = area
        deviations[name] = _deviation(np.where(counted > 0, distances, 0.0), points, counted)
    return deviations, beyond


def _signed_distances(
    points: Array, V: Array, F: NDArray[Any], most: float | None
) -> tuple[Array, NDArray[np.bool_]]:
    """Return the distances of points to a surface, positive on the side its normals point to.

    And for which of them the nearest point is on its rim, or farther than `most`.
    """
    import pyvista

    # At an edge VTK takes the normals of both faces; it needs them to share its vertices.
    X, index = np.unique(V, axis=0, return_inverse=True)
    G = index.reshape(-1)[F]
    G = G[np.linalg.norm(area_vectors(X, G), axis=1) > 0]
    surface = pyvista.PolyData.from_regular_faces(X, G)
    measured = pyvista.PolyData(points).compute_implicit_distance(surface)
    distances = np.asarray(measured["implicit_distance"], dtype=np.float64)
    is_beyond = np.zeros(len(points), bool) if most is None else np.abs(distances) > most
    rim = surface.extract_feature_edges(
        feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )
    if rim.n_cells:
        cells, nearest = surface.find_closest_cell(points, return_closest_point=True)
        _, on_rim = rim.find_closest_cell(nearest, return_closest_point=True)
        at_rim = np.linalg.norm(on_rim - nearest, axis=1)
        tiny = _AT_RIM * float(np.linalg.norm(np.ptp(X, axis=0)))
        # What lies above or below the rim is not beyond it.
        normals = area_vectors(X, G)[cells]
        height = np.abs(((points - nearest) * normals).sum(axis=1))
        size = np.linalg.norm(points - nearest, axis=1) * np.linalg.norm(normals, axis=1)
        is_beyond |= (at_rim <= tiny) & (height < _ABOVE * size) & (np.abs(distances) > tiny)
    return distances, is_beyond


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


def _is_closed(V: Array, F: NDArray[Any]) -> bool:
    """Whether a surface is closed: the integrals of n and x n^T are then 0 and volume * I."""
    vectors = area_vectors(V, F)
    limit = _CLOSED * float(np.linalg.norm(vectors, axis=1).sum())
    moments = (V - V.mean(axis=0))[F].mean(axis=1).T @ vectors
    moments -= np.eye(3) * np.trace(moments) / 3
    extent = float(np.linalg.norm(np.ptp(V, axis=0)))
    is_balanced = np.linalg.norm(vectors.sum(axis=0)) <= limit
    return bool(is_balanced and np.linalg.norm(moments) <= limit * extent)


def _volume(V: Array, F: NDArray[Any]) -> float:
    apex = V[F[:, 0]] - V.mean(axis=0)
    return float((apex * area_vectors(V, F)).sum() / 3)
