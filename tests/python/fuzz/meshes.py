"""Small meshes of every kind, made from descriptions that hypothesis draws and shrinks.

tests/fuzz/meshes.cpp makes those of the core's fuzzer from seeds, which cannot be shrunk, and knows
neither polygons nor attributes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pymeshlab
from hypothesis import strategies as st
from numpy.typing import NDArray

Description = dict[str, Any]
ATTRIBUTE = "age"


@dataclass
class Shape:
    """A mesh of polygons.

    Attributes
    ----------
    V
        n x 3 coordinates.
    polygons
        Vertex indices of each, at least three.
    """

    V: NDArray[np.float64]
    polygons: list[list[int]]

    def triangles(self) -> NDArray[np.int32]:
        """Split every polygon into a fan."""
        fans = [[p[0], p[i], p[i + 1]] for p in self.polygons for i in range(1, len(p) - 1)]
        return np.array(fans, np.int32).reshape(-1, 3)


def _quads(n: int, m: int, around: bool, across: bool) -> list[list[int]]:
    """Quadrilaterals of n x m vertices, closed in either direction."""
    return [
        [i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m]
        for i in range(n if around else n - 1)
        for j in range(m if across else m - 1)
    ]


def _torus(n: int, m: int, radius: float) -> Shape:
    u, v = np.meshgrid(2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(m) / m, indexing="ij")
    ring = 1 + radius * np.cos(v)
    V = np.stack([ring * np.cos(u), ring * np.sin(u), radius * np.sin(v)], axis=-1)
    return Shape(V.reshape(-1, 3), _quads(n, m, True, True))


def _grid(n: int, m: int, height: float) -> Shape:
    u, v = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, m), indexing="ij")
    V = np.stack([u, v, height * np.sin(5 * u) * np.cos(4 * v)], axis=-1)
    return Shape(V.reshape(-1, 3), _quads(n, m, False, False))


def _wheel(rim: int, closed: bool, height: float) -> Shape:
    angle = 2 * np.pi * np.arange(rim) / rim
    V = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    hubs = [[0, 0, height], [0, 0, -height]] if closed else [[0, 0, height]]
    polygons = [[i, (i + 1) % rim, rim] for i in range(rim)]
    if closed:
        polygons += [[(i + 1) % rim, i, rim + 1] for i in range(rim)]
    return Shape(np.vstack([V, hubs]), polygons)


def _soup(n: int, m: int, seed: int) -> Shape:
    """Random triangles between random points; a triangle may repeat a vertex."""
    rng = np.random.default_rng(seed)
    return Shape(rng.standard_normal((n, 3)), rng.integers(n, size=(m, 3)).tolist())


def _crumbs(count: int, distance: float, seed: int) -> Shape:
    """Tetrahedra far from one another."""
    rng = np.random.default_rng(seed)
    V = np.vstack(
        [np.vstack([np.zeros(3), np.eye(3)]) + distance * rng.uniform(size=3) for _ in range(count)]
    )
    corners = ([0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3])
    return Shape(V, [[4 * i + c for c in p] for i in range(count) for p in corners])


def _triangle() -> Shape:
    return Shape(np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 0.8, 0]]), [[0, 1, 2]])


def _cloud(n: int) -> Shape:
    return Shape(np.random.default_rng(n).standard_normal((n, 3)), [])


_SHAPES = {
    "torus": _torus,
    "grid": _grid,
    "wheel": _wheel,
    "soup": _soup,
    "crumbs": _crumbs,
    "triangle": _triangle,
    "cloud": _cloud,
}


def _change(shape: Shape, name: str, where: int, amount: float) -> None:
    """Spoil a shape in one way; `where` chooses vertices and polygons, `amount` is in (0, 1]."""
    V, polygons = shape.V, shape.polygons
    if not polygons:
        return
    i, polygon = where % len(V), polygons[where % len(polygons)]
    a, b = polygon[0], polygon[1]
    if name == "noise":
        rng = np.random.default_rng(where)
        shape.V = V + 0.1 * amount**4 * rng.standard_normal(V.shape)
    elif name == "spike":
        V[i] *= 10 ** (7 * amount)
    elif name == "short edge":
        V[a] = V[b] + 1e-3 * amount**8 * (V[a] - V[b])
    elif name == "collapsed edge":
        V[a] = V[b]
    elif name == "flat triangle":
        V[a] = (V[b] + V[polygon[-1]]) / 2
    elif name == "duplicate face":
        polygons.append(list(polygon))
    elif name == "flipped face":
        polygon.reverse()
    elif name == "turned inside out":
        for each in polygons:
            each.reverse()
    elif name == "duplicate vertex":
        polygon[0] = len(V)
        shape.V = np.vstack([V, V[a]])
    elif name == "welded vertices":
        j = (where // 7) % len(V)
        shape.polygons = [[j if c == i else c for c in each] for each in polygons]
    elif name == "hole":
        del polygons[where % len(polygons)]
    elif name == "fins":
        for k in range(1 + where % 4):
            shape.V = np.vstack([shape.V, V[a] + [0.1, 0.2, 0.3 * k]])
            polygons.append([a, b, len(shape.V) - 1])
    elif name == "isolated vertex":
        shape.V = np.vstack([V, [amount, -1.0, 0.5]])
    elif name == "stray vertex":
        shape.V = np.vstack([V, [10 ** (20 * amount), 1.0, -1.0]])
    elif name == "flattened":
        V[:, 2] *= 0.0 if amount > 0.5 else 1e-9
    elif name == "stretched":
        V[:, 0] *= 10 ** (12 * amount - 6)
    elif name == "on a lattice":
        V[:] = np.round(V / amount) * amount
    elif name == "second component":
        other = _torus(3, 4, 0.3)
        polygons += [[c + len(V) for c in each] for each in other.polygons]
        shape.V = np.vstack([V, other.V * amount**8 + [100 * amount, 0, 0]])


_CHANGES = (
    "noise",
    "spike",
    "short edge",
    "collapsed edge",
    "flat triangle",
    "duplicate face",
    "flipped face",
    "turned inside out",
    "duplicate vertex",
    "welded vertices",
    "hole",
    "fins",
    "isolated vertex",
    "stray vertex",
    "flattened",
    "stretched",
    "on a lattice",
    "second component",
)
_HEIGHTS = (0.3, 0.0, 1e-4, 30.0)
_TRANSFORMS: dict[str, list[list[float]]] = {
    "rotation": [[0, -1, 0, 5], [1, 0, 0, -2], [0, 0, 1, 0], [0, 0, 0, 1]],
    "scaling": [[1e3, 0, 0, 0], [0, 1e3, 0, 0], [0, 0, 1e3, 0], [0, 0, 0, 1]],
    "mirror and shear": [[-1, 2, 0, 1], [0, 1, 0, 0], [0, 0, 1e-3, 0], [0, 0, 0, 1]],
    "projection to a point": [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1]],
}


def _seldom(usual: Any, *others: Any) -> st.SearchStrategy[Any]:
    return st.integers(0, 7).flatmap(
        lambda k: st.sampled_from(others) if k == 7 else st.just(usual)
    )


def descriptions() -> st.SearchStrategy[Description]:
    """Draw descriptions for `shape_of` and `mesh_set_of`, the simplest first."""
    seeds, heights = st.integers(0, 999), st.sampled_from(_HEIGHTS)
    sides = st.integers(3, 14)
    shapes = st.one_of(
        st.tuples(st.just("torus"), sides, sides, st.sampled_from((0.4, 0.05, 0.9))),
        st.tuples(st.just("grid"), st.integers(2, 14), st.integers(2, 14), heights),
        st.tuples(st.just("wheel"), st.sampled_from((3, 5, 17, 60, 250)), st.booleans(), heights),
        st.tuples(st.just("soup"), st.integers(3, 40), st.integers(1, 80), seeds),
        st.tuples(
            st.just("crumbs"), st.integers(1, 30), st.sampled_from((3.0, 1e7, 1e12, 1e16)), seeds
        ),
        _seldom(("triangle",), ("cloud", 1), ("cloud", 9)),
    )
    changes = st.tuples(
        st.sampled_from(_CHANGES), seeds, st.sampled_from((1.0, 0.7, 0.5, 0.3, 0.1, 0.01))
    )
    exponents = _seldom(0, -60, -40, -20, -6, 6, 16, 17, 36, 37, 75)
    return st.fixed_dictionaries(
        {
            "shape": shapes,
            "changes": st.lists(changes, max_size=3),
            "exponent": exponents,
            "offset": _seldom(0.0, 1.0, 1e3, 1e7, 1e12),
            "spoiled": _seldom(
                "", "", "", "nan", "inf", "-inf", "empty", "no faces", "nan quality"
            ),
            "where": seeds,
            "polygons": st.booleans(),
            "deleted": _seldom("", "vertices", "faces", "everything"),
            "transform": _seldom("", *_TRANSFORMS),
            "selected": st.sampled_from(("", "", "vertices", "faces", "all")),
        }
    )


def shape_of(description: Description) -> Shape:
    """Make the shape that is described."""
    name, *arguments = description["shape"]
    shape = _SHAPES[name](*arguments)
    for change in description["changes"]:
        _change(shape, *change)
    shape.V = shape.V * 10.0 ** description["exponent"]
    diagonal = float(np.linalg.norm(np.ptp(shape.V, axis=0)))
    shape.V = shape.V + description["offset"] * diagonal * np.array([1.0, -0.3, 0.1])
    spoiled = description["spoiled"]
    if spoiled in ("nan", "inf", "-inf"):
        shape.V[description["where"] % len(shape.V), description["where"] % 3] = float(spoiled)
    elif spoiled in ("empty", "no faces"):
        shape.polygons = []
    return shape


def mesh_set_of(description: Description) -> pymeshlab.MeshSet:
    """Make a MeshSet with the mesh that is described, and one of every attribute."""
    shape = shape_of(description)
    n, rng = len(shape.V), np.random.default_rng(1)
    attributes: dict[str, Any] = {
        "v_scalar_array": rng.random(n),
        "v_color_matrix": rng.random((n, 4)),
    }
    if description["spoiled"] == "nan quality":
        attributes["v_scalar_array"][description["where"] % n] = np.nan
    if description["polygons"] and shape.polygons:
        faces: Any = [np.array(p, np.uint32) for p in shape.polygons]
        mesh = pymeshlab.Mesh(shape.V, faces, **attributes)
    else:
        F = shape.triangles()
        attributes["w_tex_coords_matrix"] = rng.random((3 * len(F), 2))
        mesh = pymeshlab.Mesh(shape.V, F, **attributes)
    mesh_set = pymeshlab.MeshSet(verbose=True)
    mesh_set.add_mesh(mesh)
    mesh_set.current_mesh().add_vertex_custom_scalar_attribute(rng.random(n), ATTRIBUTE)
    if description["transform"]:
        matrix = np.array(_TRANSFORMS[description["transform"]], float)
        mesh_set.set_matrix(transformmatrix=matrix, freeze=False)
    if description["selected"] == "all":
        mesh_set.set_selection_all()
    elif description["selected"] == "vertices":
        mesh_set.compute_selection_by_condition_per_vertex(condselect="(sin(7 * vi) > 0)")
    elif description["selected"] == "faces" and shape.polygons:
        _select_faces(mesh_set, "(sin(7 * vi) > -0.8)")
    deleted = "everything" if description["spoiled"] == "empty" else description["deleted"]
    if deleted != "faces" or shape.polygons:
        _delete(mesh_set, deleted)
    return mesh_set


def _select_faces(mesh_set: pymeshlab.MeshSet, condition: str) -> None:
    """Select the faces whose vertices meet a condition.

    MeshLab's filter for conditions of faces crashes now and then on a mesh of polygons: it reads
    their attribute of integers as one of floats.
    """
    mesh_set.compute_selection_by_condition_per_vertex(condselect=condition)
    mesh_set.compute_selection_transfer_vertex_to_face()
    mesh_set.set_selection_none(allfaces=False)


def _delete(mesh_set: pymeshlab.MeshSet, what: str) -> None:
    if what == "everything":
        mesh_set.set_selection_all()
        mesh_set.meshing_remove_selected_vertices()
    elif what == "vertices":
        mesh_set.compute_selection_by_condition_per_vertex(condselect="(sin(7 * vi) > 0.8)")
        mesh_set.meshing_remove_selected_vertices()
    elif what == "faces":
        _select_faces(mesh_set, "(sin(7 * vi) > 0)")
        mesh_set.meshing_remove_selected_faces()
