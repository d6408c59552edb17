"""Figures of the method: `python -m meshlab_spectral.figures MESH PICTURE`.

The figure shows why the filter is fractional. The same strong low-pass, once applied in one shot
and once in ten steps: the first turns thin parts into spikes, the second draws them in.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from meshlab_spectral.errors import SpectralError
from meshlab_spectral.options import FilterOptions, Length
from meshlab_spectral.pictures import Panel, View, draw_side_by_side
from meshlab_spectral.plugin import FILTER_NAME, load


def draw_stability(mesh_file: Path, picture: Path, feature_size: Length) -> None:
    """Draw a mesh, its one-shot low-pass and its conformal low-pass in ten steps.

    Parameters
    ----------
    mesh_file
        A mesh that looks along z, with y up, such as the Stanford dragon.
    picture
        The .png file to write.
    feature_size
        Of the low-pass.
    """
    import pymeshlab

    load()
    columns = {
        "original": None,
        f"low-pass {feature_size}, one shot": FilterOptions(
            feature_size=feature_size, steps=1, basis_update="none"
        ),
        f"low-pass {feature_size}, ten conformal steps": FilterOptions(
            feature_size=feature_size, steps=10, basis_update="conformal"
        ),
    }
    panels = []
    for label, options in columns.items():
        mesh_set = pymeshlab.MeshSet()
        mesh_set.load_new_mesh(str(mesh_file))
        if options is not None:
            mesh_set.apply_filter(FILTER_NAME, **options.pymeshlab_parameters())
        panels.append(Panel.of(label, mesh_set.current_mesh()))
    draw_side_by_side(panels, picture, view=View(zoom=1.45), panel_size=(800, 620))


def _main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m meshlab_spectral.figures", description="Draw one shot beside ten steps."
    )
    parser.add_argument("mesh", type=Path, help="e.g. the Stanford dragon, dragon_40k.ply")
    parser.add_argument("picture", type=Path, help="the .png file to write")
    parser.add_argument("--feature-size", default="15%", help="e.g. 15%% or 0.5")
    arguments = parser.parse_args()
    try:
        draw_stability(
            arguments.mesh,
            arguments.picture,
            Length.parse(arguments.feature_size),
        )
    except SpectralError as error:
        sys.exit(f"Error: {error}")


if __name__ == "__main__":
    _main()
