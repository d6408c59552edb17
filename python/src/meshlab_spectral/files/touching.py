"""Meshes of a file that meet: pieces of one surface, and closed parts that touch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshlab_spectral._core import first_equal_rows
from meshlab_spectral.documents.document import Array, Indices, Part

_ROUND_OFF = 1e-6  # of the diagonal: placed by different transforms, borders differ in last digits


def pieces(parts: Sequence[Part]) -> list[list[Part]]:
    """Group the parts that have edges of their boundaries in common: each group is one surface.

    Groups and their parts are in the order of the parts.
    """
    if len(parts) == 1:
        return [list(parts)]
    points = np.vstack([part.vertices for part in parts])
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0
    place = first_equal_rows(np.round(points / (_ROUND_OFF * diagonal)))
    begins = np.cumsum([0, *(len(part.vertices) for part in parts)])
    edges = [
        _boundary(place[part.faces + begin]) for part, begin in zip(parts, begins, strict=False)
    ]
    every = np.vstack(edges)
    owner = np.repeat(np.arange(len(parts)), [len(one) for one in edges])
    _, edge = np.unique(every, axis=0, return_inverse=True)
    order = np.lexsort((owner, edge.ravel()))
    edge, owner = edge.ravel()[order], owner[order]
    same = edge[1:] == edge[:-1]
    pairs = np.unique(np.column_stack([owner[:-1], owner[1:]])[same], axis=0)
    above = list(range(len(parts)))

    def first_of(one: int) -> int:
        while above[one] != one:
            above[one] = one = above[above[one]]
        return one

    for one, other in pairs.tolist():
        first, second = sorted((first_of(one), first_of(other)))
        above[second] = first
    groups: dict[int, list[Part]] = {}
    for number, part in enumerate(parts):
        groups.setdefault(first_of(number), []).append(part)
    return list(groups.values())


def _boundary(faces: Indices) -> Indices:
    """Return the edges with one triangle, k x 2, sorted."""
    sides = np.sort(np.vstack([faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    edges, counts = np.unique(sides[sides[:, 0] != sides[:, 1]], axis=0, return_counts=True)
    return np.asarray(edges[counts == 1], dtype=np.int64)


def moved_alike(
    parts: Sequence[Part], moved: Sequence[Array], chosen: Sequence[Part]
) -> tuple[list[Array], list[str]]:
    """Let vertices of different parts at the same position move alike, by their mean displacement.

    Parameters
    ----------
    parts
        The meshes of a file.
    moved
        Their new vertices.
    chosen
        The parts that have been filtered; the others stay as they are.

    Returns
    -------
    The new vertices, and warnings about parts that meet others which stay.
    """
    if len(parts) == 1:
        return list(moved), []
    points, after = (np.vstack(rows) for rows in ([part.vertices for part in parts], [*moved]))
    owner = np.repeat(np.arange(len(parts)), [len(part.vertices) for part in parts])
    place = first_equal_rows(points)
    is_shared = np.zeros(len(points), bool)
    is_shared[place[owner != owner[place]]] = True
    rows = np.flatnonzero(is_shared[place])
    warnings = []
    if len(rows):
        _, where = np.unique(place[rows], return_inverse=True)
        where = where.ravel()
        displacement = after[rows] - points[rows]
        first = np.zeros(where.max() + 1, np.int64)
        first[where[::-1]] = np.arange(len(rows))[::-1]
        differs = (displacement != displacement[first[where]]).any(axis=1)
        apart = np.zeros(len(first), bool)
        apart[where[differs]] = True
        filtered = set(map(id, chosen))
        stays = np.array([id(part) not in filtered for part in parts])[owner[rows]]
        fixed = np.zeros(len(first), bool)
        fixed[where[stays]] = True
        if (apart & fixed).any():
            farthest = np.linalg.norm(displacement[(apart & fixed)[where]], axis=1).max()
            warnings.append(
                f"{int((apart & fixed).sum())} vertices lie on meshes that are not filtered: there "
                f"the meshes part by up to {farthest:.3g}; leave out the name to filter all"
            )
        free = (apart & ~fixed)[where]
        count = np.bincount(where)[:, None]
        mean = np.column_stack([np.bincount(where, column) for column in displacement.T]) / count
        after[rows[free]] = points[rows[free]] + mean[where[free]]
    ends = np.cumsum([len(part.vertices) for part in parts])[:-1]
    return np.split(after, ends), warnings
