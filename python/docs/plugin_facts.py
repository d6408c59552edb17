"""What the reference pages say about the filters: read from the plugin and from the core."""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from typing import Any

import meshlab_spectral
import numpy as np
import pymeshlab
from meshlab_spectral import _core
from meshlab_spectral.plugin.library import function_of
from meshlab_spectral.plugin.loading import loaded_plugin

CONTRACT = {one["python_name"]: one for one in _core.filters()}
# Entries of reports, and what they mean.
MEANINGS: dict[str, str] = {
    name: text for one in CONTRACT.values() for name, text, _ in one["report"]
}
# Defaults that depend on the mesh.
DEFAULTS: dict[str, str] = {
    one["name"]: one["default_in_words"]
    for described in CONTRACT.values()
    for one in described["parameters"]
    if "edges" in one["default_in_words"]
} | {"selected": "on if faces are selected"}
# Resolutions of two meshes, which defaults that depend on the mesh differ on.
COARSE, FINE = 2, 6
# Runs whose reports hold all entries that there are, besides the run with the defaults.
MORE_RUNS: dict[str, dict[str, Any]] = {
    "apply_coord_spectral_filter_fractional": {
        "spectrum": "truncated",
        "basis_size": 20,
        "steps": 1,
    },
    "compute_scalar_surface_texture_per_vertex": {"form": "sphere"},
}


@dataclass(frozen=True)
class Parameter:
    """A parameter of a filter, as its dialog has it; `help` is HTML."""

    name: str
    label: str
    type: str
    help: str
    is_advanced: bool
    choices: list[str]
    default: str
    unit: str

    @property
    def is_number(self) -> bool:
        """Whether the value needs a unit."""
        return not self.choices and self.type not in ("RichBool", "RichString")

    @property
    def is_length(self) -> bool:
        """Whether it is a length, or a percentage of the diagonal."""
        return self.type in ("RichPercentage", "RichAbsPerc")

    @property
    def values(self) -> str:
        """What it may be, in words."""
        if self.choices:
            return ", ".join(self.choices)
        kinds = {"RichBool": "on or off", "RichString": "text"}
        return kinds.get(self.type) or self.unit


@dataclass(frozen=True)
class Filter:
    """A filter of the plugin; `help` is HTML."""

    name: str
    python_name: str
    menus: list[str]
    help: str
    parameters: list[Parameter]
    report: dict[str, str]  # name -> kind of value


@functools.cache
def filters() -> dict[str, Filter]:
    """Return all filters of the plugin, by their Python names."""
    meshlab_spectral.load()
    # What the dialogs say: of a filter the fields of Filter, of its parameters those of Parameter.
    text: bytes = function_of(loaded_plugin(), "meshlab_spectral_filters", ())()
    return {described["python_name"]: _filter(described) for described in json.loads(text)}


def _filter(described: dict[str, Any]) -> Filter:
    name = described["python_name"]
    defaults = [_defaults(name, described, mesh_set) for mesh_set in _spheres()]
    parameters = []
    # Units: those that the plugin alone has, such as keep_original, have none.
    units = {one["name"]: one["unit"] for one in CONTRACT[name]["parameters"]}
    for parameter in described.pop("parameters"):
        coarse, fine = (of_mesh[parameter["name"]] for of_mesh in defaults)
        default = coarse if coarse == fine else DEFAULTS[parameter["name"]]
        parameters.append(
            Parameter(**parameter, default=default, unit=units.get(parameter["name"], ""))
        )
    return Filter(**described, parameters=parameters, report=_report(name))


def _defaults(name: str, described: dict[str, Any], mesh_set: Any) -> dict[str, str]:
    """Return the defaults of a filter for a mesh, as they are shown."""
    diagonal = mesh_set.current_mesh().bounding_box().diagonal()
    values = mesh_set.filter_parameter_values(name)
    return {
        parameter["name"]: _shown(parameter, values[parameter["name"]], diagonal)
        for parameter in described["parameters"]
    }


def _shown(parameter: dict[str, Any], value: Any, diagonal: float) -> str:
    if parameter["choices"]:
        return str(parameter["choices"][value])
    if isinstance(value, bool):
        return "on" if value else "off"
    if "Perc" in parameter["type"] and value:
        return f"{100 * value / diagonal:.4g} % of the diagonal"
    return value if isinstance(value, str) else f"{value:g}"


@functools.cache
def _spheres() -> list[Any]:
    return [_sphere(COARSE), _sphere(FINE)]


def _sphere(subdivisions: int) -> Any:
    """Make a sphere that every filter accepts; the finer one has a selection."""
    mesh_set = pymeshlab.MeshSet()
    mesh_set.create_sphere(subdiv=subdivisions)
    mesh_set.compute_scalar_by_function_per_vertex(q="x")
    mesh_set.compute_color_by_function_per_vertex(x="100 * (1 + x)")
    if subdivisions == FINE:
        mesh_set.compute_selection_by_condition_per_face(condselect="x0 > 0")
    return mesh_set


def _height_map() -> pymeshlab.MeshSet:
    """Waves on a square grid: entries that only maps have."""
    n = 60
    y, x = np.mgrid[:n, :n].reshape(2, -1) / n
    corner = np.arange(n * (n - 1)).reshape(-1, n)[:, :-1].reshape(-1, 1)
    faces = np.vstack([corner + np.array(one) for one in ([0, 1, n + 1], [0, n + 1, n])])
    mesh_set = pymeshlab.MeshSet()
    waves = 0.01 * np.sin(60 * x) * np.sin(40 * y)
    mesh_set.add_mesh(pymeshlab.Mesh(np.column_stack([x, y, waves]), faces))
    return mesh_set


def _report(name: str) -> dict[str, str]:
    """Return the entries of a filter's report, and what kinds of values they are."""
    kinds = {bool: "true or false", int: "integer", float: "number"}
    entries: dict[str, str] = {}
    meshes = [_sphere(COARSE), _sphere(COARSE)] + [_height_map()] * ("texture" in name)
    for mesh_set, options in zip(meshes, ({}, MORE_RUNS.get(name, {}), {}), strict=False):
        for entry, value in mesh_set.apply_filter(name, **options).items():
            entries[entry] = kinds.get(type(value), "array")
    return entries
