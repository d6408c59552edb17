"""Every scheme computes what an independent implementation with all eigenvectors computes.

Values are the largest distances of a vertex, in diagonals of the bounding box.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import meshlab_spectral
import numpy as np
import spectral_reference as reference
from transfer_functions import RESPONSES, TYPES, gain_of

from promises.meshes import Array, Mesh, comet, diagonal, largest_distance, open_half
from promises.record import Found, Promise, at_most, largest, promise

# "accurate to 1e-6 of the size of the shape" (python/docs/limits.md).
ACCURACY = at_most(1e-6)
LAPLACIANS = ("intrinsic delaunay", "cotangent", "uniform")
SIZE = {"feature_size": "10%"}
# Of the diagonal. The tail of the comet keeps a twentieth of its area.
STRONG = {"feature_size": "20%"}


def promises() -> Iterator[Promise]:
    yield from one_step()
    yield from steps()
    yield from published_conformal_update()
    yield from truncated()
    yield from fixed_boundary()


def one_step() -> Iterator[Promise]:
    """Eq. 6 with every filter type and smooth response; `laplacian` cotangent."""
    for response, options in RESPONSES.items():
        yield promise(
            f"{response}, every filter type, off SciPy",
            ACCURACY,
            partial(worst_type, options),
        )


def steps() -> Iterator[Promise]:
    """Eq. 11, fractional steps with `basis_update` full and none, for every Laplacian."""
    cases: list[dict[str, Any]] = [
        {"steps": 8, "basis_update": "none"},
        {"steps": 8, "basis_update": "full"},
        {"steps": 4, "basis_update": "full", "conformal_share": 0.25},  # exact in 32 bits
    ]
    for case in cases:
        for laplacian in LAPLACIANS:
            yield promise(
                f"{shown(case)}, {laplacian}, off SciPy",
                ACCURACY,
                partial(difference, case | {"laplacian": laplacian}),
            )


def published_conformal_update() -> Iterator[Promise]:
    """`basis_update` conformal is the update of Kazhdan et al. 2012: D of the current shape.

    1e-7, asked where a thin part keeps a twentieth of its area: a mass that is kept from
    vanishing would be off by 1e-2 there.
    """
    for laplacian in LAPLACIANS[:2]:
        yield promise(
            f"steps 10, conformal, {laplacian}, off SciPy",
            at_most(1e-7),
            partial(difference_of_conformal, laplacian),
        )


def truncated() -> Iterator[Promise]:
    """Eqs. 6 to 10: a truncated basis, the residual reinjected or dropped."""
    for update in ("none", "full"):
        for reinject in (True, False):
            yield promise(
                f"truncated, {'with' if reinject else 'without'} residual, steps 6, {update}, "
                "off SciPy",
                ACCURACY,
                partial(difference_of_truncated, update, reinject),
            )


def fixed_boundary() -> Iterator[Promise]:
    """`boundary` fixed: Dirichlet conditions, the boundary stays."""
    for update in ("none", "full"):
        for basis_size in (None, 60):
            yield promise(
                f"fixed boundary, {'full spectrum' if basis_size is None else 'truncated'}, "
                f"steps 6, {update}, off SciPy",
                ACCURACY,
                partial(difference_of_fixed, update, basis_size),
            )


def shown(case: dict[str, Any]) -> str:
    share = case.get("conformal_share", 0)
    return f"steps {case['steps']}, {case['basis_update']}" + f", share {share}" * bool(share)


def filtered(mesh: Mesh, options: dict[str, Any]) -> tuple[Array, reference.Gain, dict[str, Any]]:
    """Return the vertices, the gain that was asked for, and the report."""
    X, report = meshlab_spectral.filter_mesh(*mesh, **options)
    return X, gain_of(options, report), report


def relative(mesh: Mesh, X: Array, expected: Array) -> float:
    """Return the largest distance in diagonals; of a filter that does something."""
    V, _ = mesh
    if largest_distance(expected, V) < 1e-3 * diagonal(V):
        raise AssertionError("the filter moves nothing")
    return largest_distance(X, expected) / diagonal(V)


def difference(options: dict[str, Any], size: dict[str, Any] = SIZE) -> float:
    """Return the difference to the reference with all eigenvectors."""
    mesh = comet()
    X, gain, _ = filtered(mesh, size | options)
    expected = reference.full_filter(
        *mesh,
        gain,
        options["steps"],
        options["basis_update"],
        options["laplacian"],
        options.get("conformal_share", 0.0),
    )
    return relative(mesh, X, expected)


def worst_type(response: dict[str, Any]) -> Found:
    case = {"steps": 1, "basis_update": "none", "laplacian": "cotangent"}
    return largest(
        (name, difference(case | kind | response, STRONG)) for name, kind in TYPES.items()
    )


def difference_of_conformal(laplacian: str) -> float:
    """Return the difference to W of the input with D of the current shape, step by step."""
    mesh = V, F = comet()
    K = 10
    options = {"steps": K, "basis_update": "conformal", "laplacian": laplacian}
    found, gain, _ = filtered(mesh, STRONG | options)
    W, _ = reference.matrices(V, F, laplacian)
    parts = reference.components(len(V), F)
    X = V
    for _ in range(K):
        spectra = reference.spectra(W, reference.lumped_areas(X, F), parts)
        X = reference.apply_gain(X, spectra, lambda omega: gain(omega) ** (1 / K))
    return relative(mesh, found, X)


def difference_of_truncated(update: str, reinject: bool) -> float:
    mesh = comet()
    case: dict[str, Any] = {"steps": 6, "basis_update": update, "laplacian": "cotangent"}
    case |= {"spectrum": "truncated", "basis_size": 100, "reinject_residual": reinject}
    X, gain, _ = filtered(mesh, SIZE | case)
    expected, _ = reference.truncated_filter(*mesh, gain, 6, update, 100, reinject)
    return relative(mesh, X, expected)


def difference_of_fixed(update: str, basis_size: int | None) -> float:
    mesh = V, F = open_half(comet())
    case: dict[str, Any] = {"steps": 6, "basis_update": update, "boundary": "fixed"}
    case["laplacian"] = "cotangent"
    if basis_size is not None:
        case |= {"spectrum": "truncated", "basis_size": basis_size}
    X, gain, _ = filtered(mesh, STRONG | case)
    expected = reference.fixed_filter(*mesh, gain, 6, update, "cotangent", basis_size)
    rim = reference.boundary_vertices(F)
    if not np.array_equal(X[rim], V[rim]):
        raise AssertionError("the boundary moves")
    return relative(mesh, X, expected)
