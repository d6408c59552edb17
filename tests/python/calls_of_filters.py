"""Calls of every filter, and meshes of many kinds to call it with: all faces must agree on them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from fuzz.meshes import shape_of
from numpy.typing import NDArray
from shared_types import Decimated


class Call(NamedTuple):
    """A filter, and values of parameters; lengths as texts, numbers as in single precision."""

    name: str
    options: dict[str, Any]


FILTER = "apply_coord_spectral_filter_fractional"
CALLS = [
    Call(FILTER, {}),
    Call(FILTER, {"feature_size": "15%", "pass_gain": 1.125, "selected": True}),
    Call(FILTER, {"filter_type": "high-pass", "stop_gain": 1.0, "weight": "vertex quality"}),
    Call(FILTER, {"filter_type": "custom", "transfer_function": "20%:1, 6e:1.7, 1%:0.1"}),
    Call(FILTER, {"spectrum": "truncated", "basis_size": 20, "steps": 2, "basis_update": "full"}),
    Call("apply_coord_spectral_denoise", {}),
    Call("apply_coord_spectral_denoise", {"noise_height": "0.3%", "keep_creases": False}),
    Call("apply_coord_spectral_equalizer", {"gain_8x": 1.75, "gain_1x": 0.0}),
    Call("apply_scalar_spectral_filter_per_vertex", {"feature_size": "10%"}),
    Call("apply_color_spectral_filter_per_vertex", {"feature_size": "10%", "stop_gain": 0.25}),
    Call("compute_scalar_spectral_artefacts_per_vertex", {"feature_size": "10%"}),
    Call("compute_scalar_manifold_harmonic_per_vertex", {"basis_size": 20, "mode": 3}),
    Call("get_geometry_spectrum", {"basis_size": 10}),
    Call("compute_scalar_surface_texture_per_vertex", {"waviness": "5%", "noise": "1%"}),
]
# Shape and changes as in tests/python/fuzz/meshes.py; the bunny is one of pymeshlab's.
SHAPES: dict[str, Any] = {
    "bunny": None,
    "closed": ("torus", 24, 16, 0.4),
    "open": ("grid", 20, 22, 0.3),
    "fins": ("torus", 22, 14, 0.3, ("fins", 3, 1.0), ("fins", 201, 1.0)),
    "hole": ("torus", 24, 14, 0.3, ("hole", 40, 1.0), ("hole", 41, 1.0)),
    "two components": ("torus", 26, 14, 0.4, ("second component", 0, 1.0)),
    "duplicate faces": ("grid", 18, 18, 0.1, ("duplicate face", 5, 1.0), ("flipped face", 9, 1.0)),
    "unused vertex": ("torus", 20, 20, 0.5, ("isolated vertex", 0, 1.0)),
    "needles": ("torus", 20, 18, 0.4, ("short edge", 33, 0.5), ("flat triangle", 77, 1.0)),
    "soup": ("soup", 200, 390, 7),
    "high valence": ("wheel", 250, True, 0.5),
}


class Inputs(NamedTuple):
    V: NDArray[np.float64]
    F: NDArray[np.int32]
    quality: NDArray[np.float64]
    levels: NDArray[np.uint8]
    selected: NDArray[np.bool_]


def inputs_of(V: NDArray[np.float64], F: NDArray[np.int32]) -> Inputs:
    rng = np.random.default_rng(1)
    V = V + 1e-3 * rng.standard_normal(V.shape)
    return Inputs(
        np.ascontiguousarray(V),
        F.astype(np.int32),
        rng.random(len(V)),
        rng.integers(0, 256, (len(V), 3), dtype=np.uint8),
        V[:, 0] > V[:, 0].mean(),
    )


def inputs_named(name: str, decimated: Decimated) -> Inputs:
    """Return one of SHAPES. `decimated` is the fixture."""
    if SHAPES[name] is None:
        return inputs_of(*decimated("bunny.obj"))
    shape = [each for each in SHAPES[name] if not isinstance(each, tuple)]
    changes = [each for each in SHAPES[name] if isinstance(each, tuple)]
    description = {"shape": shape, "changes": changes, "exponent": 0, "offset": 0, "spoiled": ""}
    made = shape_of(description)
    return inputs_of(made.V, made.triangles())
