"""keep_original: the mesh as it was becomes a layer of its own."""

from __future__ import annotations

import numpy as np
import pytest
from helpers import mesh_set_of
from shared_types import Decimated


@pytest.mark.parametrize(
    "name",
    [
        "apply_coord_spectral_filter_fractional",
        "apply_coord_spectral_denoise",
        "apply_coord_spectral_equalizer",
    ],
)
def test_the_layer_is_the_input_and_the_current_mesh_stays(name: str, decimated: Decimated) -> None:
    cow = decimated("cow.obj")
    mesh_set, alone = mesh_set_of(*cow), mesh_set_of(*cow)
    gains = {"gain_8x": 2.0} if name.endswith("equalizer") else {}
    mesh_set.compute_matrix_from_translation(axisx=3.0, freeze=False)
    before = mesh_set.current_mesh().vertex_matrix().copy()
    mesh_set.apply_filter(name, keep_original=True, **gains)
    alone.apply_filter(name, **gains)
    assert (mesh_set.mesh_number(), alone.mesh_number()) == (2, 1)
    assert mesh_set.current_mesh_id() == alone.current_mesh_id()
    np.testing.assert_array_equal(
        mesh_set.current_mesh().vertex_matrix(), alone.current_mesh().vertex_matrix()
    )
    layer = mesh_set.mesh(mesh_set.current_mesh_id() + 1)
    np.testing.assert_array_equal(layer.vertex_matrix(), before)
    assert layer.transform_matrix()[0, 3] == mesh_set.current_mesh().transform_matrix()[0, 3] == 3
    np.testing.assert_array_equal(layer.face_matrix(), mesh_set.current_mesh().face_matrix())
