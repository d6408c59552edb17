"""A demonstration: `demo.py DIR` strongly smooths the Stanford bunny.

It writes bunny_filtered.ply and before_after.png to DIR, and prints the filter's report.
"""

from __future__ import annotations

import argparse
import functools
import sys
from pathlib import Path

import numpy as np
from figure_numbers import Drawing, MeshFile, displacement
from meshlab_spectral.cli.report_table import report_table
from meshlab_spectral.errors import SpectralError
from meshlab_spectral.figures.pictures import Panel, View
from meshlab_spectral.files.whole_files import writing_whole
from meshlab_spectral.filters.fractional import filter_mesh
from meshlab_spectral.filters.option_types import Length
from meshlab_spectral.filters.options import FilterOptions
from meshlab_spectral.filters.reports import FilterReport
from rich.console import Console
from side_by_side import draw_side_by_side

OPTIONS = FilterOptions(feature_size=Length(15, "%"), steps=10, basis_update="conformal")
BUNNY_VIEW = View(direction=(0.25, 0.2, 1.0))


def demonstrate(folder: Path) -> None:
    """Filter the bunny that comes with pymeshlab; write the mesh and a picture to `folder`."""
    import pymeshlab

    before, after, report = _filtered_bunny()
    folder.mkdir(parents=True, exist_ok=True)
    mesh_file, picture = folder / "bunny_filtered.ply", folder / "before_after.png"
    mesh_set = pymeshlab.MeshSet()
    mesh_set.add_mesh(pymeshlab.Mesh(after.V, after.F))
    with writing_whole(mesh_file) as scratch:
        mesh_set.save_current_mesh(str(scratch))
    _draw([before, after], picture)

    console = Console(soft_wrap=True)
    console.print(report_table(report, "Stanford bunny, low-pass"))
    console.print(f"Mesh: {mesh_file}\nPicture: {picture}", highlight=False)


def before_and_after(mesh: MeshFile) -> Drawing:
    """Compute the demonstration's picture; it needs no mesh of the collection."""
    before, after, _ = _filtered_bunny()
    numbers = displacement(before.V, before.F, after.V)
    return Drawing(numbers, functools.partial(_draw, [before, after]))


def _filtered_bunny() -> tuple[Panel, Panel, FilterReport]:
    """Return the bunny, the filtered one, and the filter's report."""
    import pymeshlab

    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(str(bunny_file()))
    mesh = mesh_set.current_mesh()
    before = Panel(
        "Stanford bunny", mesh.vertex_matrix().copy(), mesh.face_matrix().astype(np.int64)
    )
    V, report = filter_mesh(before.V, before.F, OPTIONS)
    size = str(OPTIONS.feature_size).replace("%", " %")
    label = f"low-pass, {size} of the diagonal, {OPTIONS.steps} steps"
    return before, Panel(label, V, before.F), report


def bunny_file() -> Path:
    """Return the bunny that comes with pymeshlab."""
    import pymeshlab

    return Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / "bunny.obj"


def _draw(panels: list[Panel], path: Path) -> None:
    draw_side_by_side(panels, path, view=BUNNY_VIEW)


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", metavar="DIR", type=Path, help="folder for the results")
    folder = parser.parse_args().folder
    try:
        demonstrate(folder)
    except SpectralError as error:
        sys.exit(f"Error: {error}")


if __name__ == "__main__":
    _main()
