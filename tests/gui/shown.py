"""What the pictures of MeshLab in screenshots/ show: meshes, parameters, and the numbers of these.

The same filters run here without a screen, for the numbers recorded next to the pictures, and for
the test that compares them.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
from figure_numbers import MeshFile, Numbers, displacement
from fractional import FILTER, HEAD, diagonal, load, mean_edge, vertices
from meshlab_spectral.plugin.library import function_of
from meshlab_spectral.plugin.loading import loaded_plugin

DENOISE = "apply_coord_spectral_denoise"
EQUALIZER = "apply_coord_spectral_equalizer"
HARMONIC = "compute_scalar_manifold_harmonic_per_vertex"

BUNNY = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / "bunny.obj"
DRAGON, BUST = "dragon_40k.ply", "Laurana50k.ply"
MENU = "Smoothing, Fairing and Deformation"
FEATURE_SIZE = 10  # of the selection, percent
GAINS = (1.0, 1.0, 1.0, 1.5, 2.5, 1.0)  # of the equalizer, from large details to small ones
MODE = 12


def bunny() -> pymeshlab.MeshSet:
    """Load the bunny, with coordinates that both precisions represent exactly."""
    mesh_set = load(BUNNY)
    mesh = mesh_set.current_mesh()
    V = mesh.vertex_matrix().astype(np.float32).astype(np.float64)
    mesh_set.add_mesh(pymeshlab.Mesh(V, mesh.face_matrix()))
    return mesh_set


def noisy_bunny() -> pymeshlab.MeshSet:
    """Add noise of a fifth of an edge along every axis to the bunny."""
    mesh_set = bunny()
    V, F = vertices(mesh_set), mesh_set.current_mesh().face_matrix()
    noise = 0.2 * mean_edge(mesh_set) * np.random.default_rng(1).standard_normal(V.shape)
    mesh_set.add_mesh(pymeshlab.Mesh((V + noise).astype(np.float32), F))
    return mesh_set


def menu(mesh: MeshFile) -> Numbers:
    """Number the plugin's entries of the menu."""
    described = json.loads(function_of(loaded_plugin(), "meshlab_spectral_filters", ())())
    entries = sorted(entry["name"] for entry in described if MENU in entry["menus"])
    return {f"entry {name}": number for number, name in enumerate(entries, start=1)}


def dialog(mesh: MeshFile) -> Numbers:
    return _applied(bunny(), FILTER)


def selected(mesh: MeshFile) -> Numbers:
    mesh_set = bunny()
    mesh_set.compute_selection_by_condition_per_face(condselect=HEAD)
    return _applied(mesh_set, FILTER, feature_size=pymeshlab.PercentageValue(FEATURE_SIZE))


def dragon(mesh: MeshFile) -> Numbers:
    return _applied(load(mesh(DRAGON)), FILTER)


def denoised(mesh: MeshFile) -> Numbers:
    return _applied(noisy_bunny(), DENOISE)


def equalized(mesh: MeshFile) -> Numbers:
    mesh_set = load(mesh(BUST))
    sliders = [name for name in mesh_set.filter_parameter_values(EQUALIZER) if "gain" in name]
    return _applied(mesh_set, EQUALIZER, **dict(zip(sliders, GAINS, strict=True)))


def harmonic(mesh: MeshFile) -> Numbers:
    mesh_set = bunny()
    values = mesh_set.apply_filter(HARMONIC, mode=MODE)["eigenvalues"]
    return {f"eigenvalue {MODE}": float(values[MODE])}


def _applied(mesh_set: pymeshlab.MeshSet, name: str, **parameters: Any) -> Numbers:
    """Apply a filter; return how far it moves the mesh, and the lengths that its dialog shows."""
    V, F = vertices(mesh_set), mesh_set.current_mesh().face_matrix()
    percent = 100 / diagonal(V)
    defaults = mesh_set.filter_parameter_values(name)
    sizes = {
        f"{size.replace('_', ' ')}, %": percent * defaults[size]
        for size in ("feature_size", "smallest_size")
        if size in defaults and size not in parameters
    }
    mesh_set.apply_filter(name, **parameters)
    return sizes | displacement(V, F, vertices(mesh_set))


PICTURES: dict[str, Callable[[MeshFile], Numbers]] = {
    "meshlab_menu": menu,
    "meshlab_dialog": dialog,
    "meshlab_selection": selected,
    "meshlab_dragon_before_after": dragon,
    "meshlab_denoise": denoised,
    "meshlab_equalizer": equalized,
    "meshlab_harmonic": harmonic,
}
