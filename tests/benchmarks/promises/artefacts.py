"""Strong filters leave no spikes."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import meshlab_spectral
import numpy as np
from spectral_reference import Indices, artefacts, lumped_areas

from promises.meshes import Array, diagonal, loaded
from promises.record import Promise, at_most, promise

MESHES = ("data/dragon_40k.ply", "data/angel_50k.ply")
PERCENTAGES = (10, 15, 25)
ONE_SHOT = {"steps": 1, "basis_update": "none"}


def promises() -> Iterator[Promise]:
    yield from lower_spikes()
    yield from the_measure()


def lower_spikes() -> Iterator[Promise]:
    """ "A strong filter leaves no spikes" (README.md), with nothing chosen but the size.

    The largest vertex of what lies above twice the cutoff in the result's own spectrum, over that
    of one shot, measured with SciPy and robust_laplacian. 0.72: one shot leaves spikes that are
    plain to see; a third less, none.
    """
    for mesh in MESHES:
        for percentage in PERCENTAGES:
            yield promise(
                f"low-pass {percentage} %, largest artefact over that of one shot: {mesh}",
                at_most(0.72),
                partial(over_one_shot, mesh, percentage),
            )


def the_measure() -> Iterator[Promise]:
    """Spectral Artefacts computes `X - g(A) X` (python/docs/guides/choosing.md), here with SciPy.

    1e-6 of the diagonal: the accuracy of a full spectrum.
    """
    yield promise(
        "Spectral Artefacts against SciPy, in diagonals: dragon_40k, 15 % in one shot",
        at_most(1e-6),
        partial(difference_of_measures, MESHES[0], 15),
    )


def over_one_shot(mesh: str, percentage: int) -> float:
    """Return the largest artefact of a default run over that of one shot."""

    def left(options: dict[str, Any]) -> float:
        X, F, size = low_passed(mesh, percentage, options)
        return float(artefacts(X, F, size).max())

    return left({}) / left(ONE_SHOT)


def low_passed(mesh: str, percentage: int, options: dict[str, Any]) -> tuple[Array, Indices, float]:
    V, F = loaded(mesh)
    size = percentage / 100 * diagonal(V)
    X, _ = meshlab_spectral.filter_mesh(V, F, feature_size=size, **options)
    return X, F, size


def difference_of_measures(mesh: str, percentage: int) -> float:
    X, F, size = low_passed(mesh, percentage, ONE_SHOT)
    found = meshlab_spectral.measure_artefacts(X, F, size).length
    expected = artefacts(X, F, size, lumped_areas(X, F))
    return float(np.abs(found - expected).max() / diagonal(loaded(mesh)[0]))
