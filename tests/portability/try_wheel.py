"""Tries an installed wheel, on any system: the filters, an expression, and two commands.

usage: python try_wheel.py    in an environment with the wheel
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import meshlab_spectral
import numpy as np
import pymeshlab


def main() -> None:
    """Filter a noisy sphere in every way that leads to the plugin."""
    meshlab_spectral.load()
    meshes = pymeshlab.MeshSet()
    meshes.create_sphere(subdiv=5)
    sphere = meshes.current_mesh().vertex_matrix()
    meshes.apply_coord_random_displacement()
    with tempfile.TemporaryDirectory() as folder:
        scans, smooth = Path(folder) / "scans", Path(folder) / "smooth"
        scans.mkdir()
        meshes.save_current_mesh(str(scans / "noisy.ply"))

        report = meshes.apply_coord_spectral_filter_fractional(
            filter_type="custom", transfer_function="1 / (1 + w^4)"
        )
        print(report)
        assert report["accuracy_reached"], report

        clean = Path(folder) / "clean.ply"
        command("denoise", scans / "noisy.ply", clean)
        meshes.load_new_mesh(str(clean))
        radii = np.linalg.norm(meshes.current_mesh().vertex_matrix(), axis=1)
        assert abs(radii.mean() / np.linalg.norm(sphere, axis=1).mean() - 1) < 0.01

        command("batch", scans, "--output", smooth, "--feature-size", "6e", "--workers", "2")
        assert (smooth / "noisy.ply").stat().st_size > 0


def command(*arguments: object) -> None:
    """Run `meshlab-spectral`, which must succeed."""
    subprocess.run(["meshlab-spectral", *map(str, arguments)], check=True, timeout=600)


if __name__ == "__main__":
    main()
