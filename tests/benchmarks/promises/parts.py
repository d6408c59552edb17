"""What must not change is left bit-for-bit unchanged: selections, boundaries, volumes."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import meshlab_spectral
import numpy as np
import scipy.sparse.csgraph
import spectral_reference as reference
from scipy.spatial import cKDTree

from promises.meshes import Array, diagonal, largest_distance, loaded, neighbours
from promises.record import Found, Promise, at_most, exactly, promise

IGEA, BUNNY = "data/igea.ply", "data/stanford-bunny.obj"
SIZE = 0.06  # of the diagonal
# The effect fades out "within about a feature size" (python/docs/guides/regions.md).
REACH = 1.25
CLOSED = ("data/greek_helmet.obj", "data/dragon_40k.ply", "data/brain_t1_279k.ply")
OPEN = ("data/camelhead.off", "data/rangescan_lato000.ply")


def promises() -> Iterator[Promise]:
    yield from selection()
    yield from weights()
    yield from volume()
    yield from boundary()
    yield from threads()


def selection() -> Iterator[Promise]:
    """A selection is filtered as in the whole mesh; beyond its fade nothing changes."""
    for name in (IGEA, BUNNY):
        yield promise(
            f"vertices moved, {REACH} feature sizes off a selection: {name}",
            exactly(0),
            partial(moved_beyond, name),
        )
        yield promise(
            f"selected vertices, off the whole mesh's, in diagonals: {name}",
            at_most(1e-14),
            partial(off_the_whole, name),
        )


def weights() -> Iterator[Promise]:
    """`weight` scales the displacement of every vertex (python/docs/guides/regions.md)."""
    yield promise(
        "half a weight, off half the displacement, in diagonals",
        at_most(1e-14),
        off_half,
    )


def volume() -> Iterator[Promise]:
    """`preserve_volume`: "closed components, to 1e-9" (python/docs/comparison.md).

    Of as many as the report counts: those that have shrunk to points it counts in a warning.
    """
    for name in CLOSED:
        yield promise(
            f"relative change of the volume of a closed component: {name}",
            at_most(1e-9),
            partial(change_of_volumes, name),
        )


def boundary() -> Iterator[Promise]:
    """With `boundary` fixed boundaries do not move at all (python/docs/inputs.md)."""
    for name in OPEN:
        yield promise(f"boundary vertices moved: {name}", exactly(0), partial(rim_moved, name))


def threads() -> Iterator[Promise]:
    """ "Results are bit-identical for every number" of threads (python/docs/limits.md)."""
    yield promise("coordinates that differ with one thread and with three", exactly(0), by_threads)


def filtered(name: str, **options: Any) -> Array:
    X, _ = meshlab_spectral.filter_mesh(*loaded(name), **options)
    return np.asarray(X)


def of_selection(name: str) -> tuple[Array, Any]:
    """Filter the top of a mesh; return its vertices and which were selected."""
    V, _ = loaded(name)
    selected = V[:, 1] > np.quantile(V[:, 1], 0.7)
    return filtered(name, feature_size=f"{SIZE:%}", selection=selected), selected


def moved_beyond(name: str) -> int:
    V, _ = loaded(name)
    X, selected = of_selection(name)
    distance, _ = cKDTree(V[selected]).query(V)
    beyond = distance > REACH * SIZE * diagonal(V)
    if beyond.sum() < 100 or not np.any(X[selected] != V[selected]):
        raise AssertionError("nothing moves, or nothing is to stay")
    return int(np.any(X[beyond] != V[beyond], axis=1).sum())


def off_the_whole(name: str) -> float:
    X, selected = of_selection(name)
    whole = filtered(name, feature_size=f"{SIZE:%}")
    return largest_distance(X[selected], whole[selected]) / diagonal(loaded(name)[0])


def off_half() -> float:
    V, _ = loaded(BUNNY)
    half, whole = (filtered(BUNNY, weights=np.full(len(V), weight)) for weight in (0.5, 1.0))
    return largest_distance(half, (V + whole) / 2) / diagonal(V)


def change_of_volumes(name: str) -> Found:
    """Return the largest change of a volume; of closed, consistently oriented components."""
    V, F = loaded(name)
    X, report = meshlab_spectral.filter_mesh(V, F, preserve_volume=True)
    _, component = scipy.sparse.csgraph.connected_components(neighbours(F, len(V)))
    of_face = component[F[:, 0]]
    changes = []
    for number in np.setdiff1d(of_face, of_face[unmatched_sides(F)]):
        faces = F[of_face == number]
        centre = V[faces[0, 0]]
        before, after = (reference.signed_volume(Y, faces, centre) for Y in (V, X))
        changes.append(abs(after / before - 1))
    count = report["preserved_volumes"]
    return Found(sorted(changes)[count - 1], f"{count} of {len(changes)} components")


def unmatched_sides(F: Any) -> Any:
    """Faces with a side that is not that of exactly one other face, in the other direction."""
    sides = np.stack([F, np.roll(F, -1, axis=1)], axis=2).reshape(-1, 2).astype(np.int64)
    forward, backward = (sides @ [F.max() + 1, 1] for sides in (sides, sides[:, ::-1]))
    keys, counts = np.unique(forward, return_counts=True)
    place = np.minimum(np.searchsorted(keys, backward), len(keys) - 1)
    is_matched = (keys[place] == backward) & (counts[place] == 1)
    return np.unique(np.flatnonzero(~is_matched) // 3)


def rim_moved(name: str) -> int:
    V, F = loaded(name)
    X = filtered(name, boundary="fixed")
    rim = reference.boundary_vertices(F)
    if len(rim) < 10:
        raise AssertionError("there is no boundary")
    return int(np.any(X[rim] != V[rim], axis=1).sum())


def by_threads() -> int:
    before = meshlab_spectral.threads()
    results = []
    try:
        for count in (1, 3):
            meshlab_spectral.set_threads(count)
            results.append(filtered(BUNNY, feature_size="15%"))
    finally:
        meshlab_spectral.set_threads(before)
    return int((results[0] != results[1]).sum())
