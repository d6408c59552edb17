"""Meshes of a file that meet: pieces of one surface, and closed parts that touch."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from meshlab_spectral import _core
from meshlab_spectral._core import first_equal_rows
from meshlab_spectral.formats.document import Array, Part, joined, split
from meshlab_spectral.warned import Warned


def pieces(parts: Sequence[Part]) -> list[list[Part]]:
    """Group the parts that are joined at seams (seams.h): each group is one surface.

    Groups and their parts are in the order of the parts.
    """
    if len(parts) == 1:
        return [list(parts)]
    pairs = [(number, number) for number in range(len(parts))]
    owner = dict[int, int]()  # the first part of each component
    for number, own in enumerate(split(_core.components(*_arrays(parts)), parts)):
        for component in np.unique(own[own >= 0]).tolist():
            pairs.append((owner.setdefault(component, number), number))
    first = least_linked(pairs)
    groups: dict[int, list[Part]] = {}
    for number, part in enumerate(parts):
        groups.setdefault(first[number], []).append(part)
    return list(groups.values())


def least_linked(pairs: Iterable[Sequence[int]]) -> dict[int, int]:
    """Return the least of the numbers that pairs link each number with, directly or by others."""
    above: dict[int, int] = {}

    def least(one: int) -> int:
        while above.setdefault(one, one) != one:
            above[one] = one = above[above[one]]
        return one

    for pair in pairs:
        first, second = sorted(map(least, pair))
        above[second] = first
    return {one: least(one) for one in above}


def _arrays(parts: Sequence[Part]) -> tuple[Array, NDArray[np.int32]]:
    V, F = joined(parts)
    return np.ascontiguousarray(V), np.ascontiguousarray(F, dtype=np.int32)


def moved_alike(
    parts: Sequence[Part], moved: Sequence[Array], chosen: Sequence[Part]
) -> tuple[list[Array], list[Warned]]:
    """Let parts move alike where they touch (contacts.h), by their mean displacement.

    `parts` are the meshes of a file, `moved` their new vertices; those `chosen` have been filtered,
    the others stay as they are. Returns the new vertices, and warnings about parts that meet others
    which stay.
    """
    if len(parts) == 1:
        return list(moved), []
    V, F = _arrays(parts)
    displacement = np.vstack([*moved]) - V
    alike = _core.moved_alike(V, F, displacement)
    after = np.vstack([*moved])
    differs = (alike != displacement).any(axis=1)
    after[differs] = (V + alike)[differs]
    return split(after, parts), _parted(parts, V, F, after - V, chosen)


def _parted(
    parts: Sequence[Part],
    V: Array,
    F: NDArray[np.int32],
    displacement: Array,
    chosen: Sequence[Part],
) -> list[Warned]:
    """Return the warning, if any, that parts leave others that stay, with vertices of faces."""
    owner = np.repeat(np.arange(len(parts)), [len(part.vertices) for part in parts])
    filtered = set(map(id, chosen))
    stays = np.array([id(part) not in filtered for part in parts])[owner]
    used = np.zeros(len(V), bool)
    used[F] = True
    place = first_equal_rows(V)
    fixed = np.zeros(len(V), bool)
    fixed[place[stays & used]] = True
    leaves = used & ~stays & fixed[place] & displacement.any(axis=1)
    if not leaves.any():
        return []
    farthest = np.linalg.norm(displacement[leaves], axis=1).max()
    text = (
        f"{len(np.unique(place[leaves]))} vertices lie on meshes that are not filtered: there "
        f"the meshes part by up to {farthest:.3g}; leave out the name to filter all"
    )
    return [Warned("parted_meshes", text)]
