"""color_by_displacement: vertices coloured by how far they have moved along their normals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pymeshlab
import pytest
from helpers import mesh_set_of
from shared_types import Decimated

FILTERS: dict[str, dict[str, Any]] = {
    "apply_coord_spectral_filter_fractional": {},
    "apply_coord_spectral_denoise": {"noise_height": pymeshlab.PureValue(0.01)},
    "apply_coord_spectral_equalizer": {"gain_8x": 2.0},
}


@pytest.mark.parametrize("name", FILTERS)
def test_colours_are_the_displacement_along_the_normals_from_before(
    name: str, decimated: Decimated
) -> None:
    mesh_set, alone = (mesh_set_of(*decimated("cow.obj")) for _ in range(2))
    mesh = mesh_set.current_mesh()
    V, N = mesh.vertex_matrix().copy(), mesh.vertex_normal_matrix().copy()
    N /= np.linalg.norm(N, axis=1, keepdims=True)
    report = mesh_set.apply_filter(name, color_by_displacement=True, **FILTERS[name])
    alone.apply_filter(name, **FILTERS[name])
    np.testing.assert_array_equal(mesh.vertex_matrix(), alone.current_mesh().vertex_matrix())
    np.testing.assert_array_equal(alone.current_mesh().vertex_color_matrix(), 1.0)

    outward = np.einsum("ij,ij->i", mesh.vertex_matrix() - V, N)
    assert report["max_outward_displacement"] == pytest.approx(outward.max(), rel=1e-9)
    assert report["max_inward_displacement"] == pytest.approx(-outward.min(), rel=1e-9)
    extent = report["color_extent"]
    assert np.mean(np.abs(outward) <= extent * (1 + 1e-9)) == pytest.approx(0.99, abs=0.002)
    share = np.clip(outward / extent, -1, 1)
    fade = 1 - np.abs(share)
    expected = np.column_stack(
        [np.where(share > 0, 1, fade), fade, np.where(share < 0, 1, fade), np.ones_like(fade)]
    )
    np.testing.assert_allclose(mesh.vertex_color_matrix(), expected, atol=0.5001 / 255)


def test_colours_of_the_file_are_kept_as_an_attribute(decimated: Decimated) -> None:
    mesh_set = mesh_set_of(*decimated("cow.obj"))
    mesh_set.compute_color_by_function_per_vertex(x="17", y="34", z="51")
    mesh_set.apply_filter("apply_coord_spectral_denoise", color_by_displacement=True, strength=0.0)
    mesh = mesh_set.current_mesh()
    before = mesh.vertex_custom_point_attribute_matrix("color_before")
    np.testing.assert_array_equal(before, np.tile([17.0, 34, 51], (mesh.vertex_number(), 1)))
    np.testing.assert_array_equal(mesh.vertex_color_matrix(), 1.0)  # nothing has moved
