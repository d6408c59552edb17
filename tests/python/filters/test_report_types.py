"""Reports have exactly the entries, of the types, that their classes say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, get_args, get_origin, get_type_hints, is_typeddict

import numpy as np
import pytest
import pyvista
from meshlab_spectral import (
    denoise_mesh,
    filter_colors,
    filter_mesh,
    filter_scalars,
    surface_texture,
)
from meshlab_spectral.filters import reports

_SPHERE = pyvista.Icosphere(nsub=3)
V, F = np.array(_SPHERE.points, dtype=float), np.array(_SPHERE.regular_faces)
_GRID = pyvista.Plane(i_resolution=60, j_resolution=60)
_GRID["waves"] = 0.01 * np.sin(_GRID.points[:, :2] * (60, 40)).prod(axis=1)
WAVES = _GRID.warp_by_scalar("waves").triangulate()
TRUNCATED: dict[str, Any] = {"spectrum": "truncated", "basis_size": 20, "steps": 1}
# Reports without and with the entries that only some have.
RUNS: dict[str, list[Callable[[], Any]]] = {
    "FilterReport": [lambda: filter_mesh(V, F)[1], lambda: filter_mesh(V, F, **TRUNCATED)[1]],
    "DenoiseReport": [
        lambda: denoise_mesh(V, F)[1],
        lambda: denoise_mesh(V, F, store_noise_height=True)[1],
    ],
    "ScalarsReport": [lambda: filter_scalars(V, F, V[:, 0])[1], lambda: filter_scalars(V, F, V)[1]],
    "ColorsReport": [lambda: filter_colors(V, F, np.abs(V))[1]],
    "TextureReport": [
        lambda: surface_texture(V, F, waviness=0.5).report,
        lambda: surface_texture(V, F, waviness=0.5, form="sphere").report,
        lambda: replace(surface_texture(WAVES), unit="mm").report,  # a height map from a file
    ],
}


@pytest.mark.parametrize("name", RUNS)
def test_a_report_has_the_entries_of_its_class(name: str) -> None:
    kind = getattr(reports, name)
    found = [run() for run in RUNS[name]]
    for report in found:
        assert kind.__required_keys__ <= report.keys() <= get_type_hints(kind).keys()
    assert set().union(*found) == get_type_hints(kind).keys()


@pytest.mark.parametrize("name", RUNS)
def test_the_entries_have_the_types_of_its_class(name: str) -> None:
    types = get_type_hints(getattr(reports, name))
    for run in RUNS[name]:
        for entry, value in run().items():
            kind = types[entry]
            if get_origin(kind) is list:
                (inner,) = get_args(kind)
                plain_type = dict if is_typeddict(inner) else inner
                assert isinstance(value, list), entry
                assert all(isinstance(one, plain_type) for one in value), entry
            else:
                assert type(value) is kind, entry


def test_every_class_of_a_report_is_tried() -> None:
    classes = {name for name in vars(reports) if name.endswith("Report") and name[0] != "_"}
    assert classes == RUNS.keys()
