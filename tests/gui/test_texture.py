"""Surface Texture in MeshLab's dialog: the report, and the heights as quality and in colours."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import plyfile
import pymeshlab
from desktop import Desktop, Picture
from fractional import load
from meshlab import MeshLab
from scene import scene_of
from waiting import wait_for

MENU = ("Quality Measure and Computations", "Surface Texture")
FILTER = "compute_scalar_surface_texture_per_vertex"


def red_and_blue(picture: Picture) -> tuple[float, float]:
    """Shares of the pixels that are clearly red, and blue."""
    red, green, blue = np.moveaxis(picture[..., :3].astype(int), -1, 0)
    return float((red > np.maximum(green, blue) + 40).mean()), float(
        (blue > np.maximum(red, green) + 40).mean()
    )


def test_heights_become_the_quality_and_are_shown_in_red_and_blue(
    meshlab: MeshLab, desktop: Desktop, bunny: Path
) -> None:
    dialog = meshlab.open_filter(*MENU)
    dialog.move(1000, 20)
    scene = scene_of(meshlab, dialog)
    before = red_and_blue(desktop.settled_picture(scene))
    # The dialog rounds its default, and the cells on which the form is taken follow the cutoff.
    field = next(row for row in dialog.rows() if "aviness" in row.label)
    waviness = pymeshlab.PureValue(float(field.editors[0].text))
    log = dialog.apply()

    def is_coloured() -> bool:
        shares = zip(before, red_and_blue(desktop.picture(scene)), strict=True)
        return all(share > share_before + 0.005 for share_before, share in shares)

    wait_for("the heights in red and blue", is_coloured)
    dialog.close()

    mesh_set = load(bunny)
    report = mesh_set.apply_filter(FILTER, waviness=waviness)
    assert f"Surface Texture: waviness cutoff {report['waviness']:.4g}" in log
    assert f"Sa {report['Sa']:.4g}, Sq {report['Sq']:.4g}" in log

    saved = meshlab.home / "texture.ply"
    meshlab.save_mesh(saved)
    heights = mesh_set.current_mesh().vertex_scalar_array()
    vertex = plyfile.PlyData.read(saved)["vertex"]
    np.testing.assert_allclose(vertex["quality"], heights, atol=2e-5 * np.abs(heights).max())
    np.testing.assert_array_equal(
        np.column_stack([vertex[axis] for axis in "xyz"]),
        mesh_set.current_mesh().vertex_matrix(),
    )
