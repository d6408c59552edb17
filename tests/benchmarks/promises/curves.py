"""Two ways to ask for one curve of gains give one result."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import meshlab_spectral
import numpy as np
import pymeshlab

from promises.meshes import Array, diagonal, largest_distance, loaded
from promises.record import Found, Promise, at_most, largest, promise

MESH = "data/rocker-arm.obj"
# The accuracy of a full spectrum (python/docs/limits.md).
ACCURACY = at_most(1e-6)
# Expressions of w = feature size / wavelength for built-in responses (README.md; order 2).
EXPRESSIONS: dict[str, tuple[dict[str, Any], str]] = {
    "Gaussian low-pass": ({}, "2^(-w^2/2)"),
    "Butterworth low-pass": ({"response": "butterworth"}, "1/sqrt(1 + w^4)"),
    "Gaussian high-pass, stop gain 1, pass gain 2": (
        {"filter_type": "high-pass", "stop_gain": 1.0, "pass_gain": 2.0},
        "1 + 2^(-w^-2/2)",
    ),
    "Gaussian band-pass, stop gain 1, pass gain 2.5": (
        {"filter_type": "band-pass", "stop_gain": 1.0, "pass_gain": 2.5},
        "1 + 1.5 * 2^(-(2*log2(w))^2/2)",
    ),
}
TIMES = (32, 16, 8, 4, 2, 1)  # smallest sizes of the sliders of the equalizer
SLIDERS = {"gain_8x": 2.0, "gain_4x": 1.5, "gain_1x": 0.5}


def promises() -> Iterator[Promise]:
    yield from expressions()
    yield from equalizer()
    yield from powers()


def expressions() -> Iterator[Promise]:
    """A `transfer_function` of the same curve is the built-in response (guides/choosing.md)."""
    for name, (options, expression) in EXPRESSIONS.items():
        yield promise(
            f"expression, off the {name}, in diagonals",
            ACCURACY,
            partial(off_the_response, options, expression),
        )


def equalizer() -> Iterator[Promise]:
    """Sliders of Spectral Equalizer, accurate, are `transfer_function` points (README.md)."""
    yield promise("Spectral Equalizer, off the same points, in diagonals", ACCURACY, off_points)


def powers() -> Iterator[Promise]:
    """`power` 0.5 is half of a filter: twice in a row it is the whole (README.md)."""
    yield promise("power 0.5, off the curve of its square root, in diagonals", ACCURACY, off_root)


def filtered(**options: Any) -> Array:
    X, _ = meshlab_spectral.filter_mesh(*loaded(MESH), **options)
    return np.asarray(X)


def custom(expression: str, **options: Any) -> Array:
    return filtered(filter_type="custom", transfer_function=expression, **options)


def apart(X: Array, Y: Array) -> float:
    """Return the largest distance in diagonals, of results that differ from the input."""
    V, _ = loaded(MESH)
    if largest_distance(X, V) < 1e-4 * diagonal(V):
        raise AssertionError("the filter moves nothing")
    return largest_distance(X, Y) / diagonal(V)


def off_the_response(options: dict[str, Any], expression: str) -> Found:
    """Compare in automatic steps and in one, at a small size and at a large one."""
    cases = [(size, steps) for size in ("4%", "15%") for steps in (0, 1)]
    common = [{"feature_size": size, "steps": steps} for size, steps in cases]
    return largest(
        (
            f"{one['feature_size']}, steps {one['steps']}",
            apart(filtered(**options, **one), custom(expression, **one)),
        )
        for one in common
    )


def off_points() -> float:
    V, F = loaded(MESH)
    smallest = 0.01 * diagonal(V)
    points = [f"{64 * smallest:.17g}:1"]
    points += [f"{times * smallest:.17g}:{SLIDERS.get(f'gain_{times}x', 1)}" for times in TIMES]
    meshlab_spectral.load()
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(V, F))
    meshes.apply_coord_spectral_equalizer(
        accurate=True, smallest_size=pymeshlab.PureValue(smallest), **SLIDERS
    )
    return apart(meshes.current_mesh().vertex_matrix(), custom(", ".join(points)))


def off_root() -> float:
    options = {"feature_size": "6%"}
    return apart(filtered(power=0.5, **options), custom("2^(-w^2/4)", **options))
