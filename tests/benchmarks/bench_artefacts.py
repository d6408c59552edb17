"""Artefacts that strong filters leave, by step scheme, as a table.

usage: bench_artefacts.py [MESH...]

Every cell holds the root mean square and the maximum of the part of a shape above twice the
filter's cutoff, in the shape's own spectrum (meshlab_spectral.measure_artefacts), both in diagonals
of the filter's input. The column "input" is the unfiltered mesh itself, for comparison. Meshes
default to the dragon and the angel next to the repository; absent ones are skipped.
"""

import pathlib
import sys
from typing import Any

import meshlab_spectral
import pymeshlab

DATA = pathlib.Path(__file__).parents[3] / "shared" / "data"
MESHES = [DATA / "dragon_40k.ply", DATA / "angel_50k.ply"]

BAND = {"filter_type": "band-pass", "stop_gain": 1.0, "pass_gain": 2.5}
FILTERS: dict[str, tuple[float, dict[str, Any]]] = {  # feature size in percent, other options
    "low-pass 15 %": (15, {}),
    "low-pass 25 %": (25, {}),
    "band enhancement 20 %": (20, BAND),
}
COLUMNS: dict[str, dict[str, Any]] = {
    "one shot": {"steps": 1, "basis_update": "none"},
    "default": {},
    "full, K = 10": {"steps": 10, "basis_update": "full"},
    "conformal, K = 10": {"steps": 10, "basis_update": "conformal"},
    "full, conformal share 0.1, K = 30": {
        "steps": 30,
        "basis_update": "full",
        "conformal_share": 0.1,
    },
}

REFUSED: list[pymeshlab.MeshSet] = []  # destroying a MeshSet after a refusal crashes pymeshlab


def loaded(mesh: pathlib.Path) -> pymeshlab.MeshSet:
    """Read a mesh."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(mesh))
    return meshes


def cell(meshes: pymeshlab.MeshSet, feature_size: float, diagonal: float) -> str:
    """Measure the current mesh."""
    mesh = meshes.current_mesh()
    found = meshlab_spectral.measure_artefacts(
        mesh.vertex_matrix(), mesh.face_matrix(), feature_size
    )
    return f"{found.rms / diagonal:.4f} / {found.maximum / diagonal:.4f}"


def filtered_cell(
    mesh: pathlib.Path, feature_size: float, diagonal: float, options: dict[str, Any]
) -> str:
    """Filter a mesh and measure the result; abbreviate a refusal."""
    meshes = loaded(mesh)
    try:
        meshes.apply_coord_spectral_filter_fractional(
            feature_size=pymeshlab.PureValue(feature_size), **options
        )
    except pymeshlab.PyMeshLabException as error:
        REFUSED.append(meshes)
        print(error, file=sys.stderr)
        return "refused"
    return cell(meshes, feature_size, diagonal)


def main() -> None:
    """Print the table row by row."""
    meshlab_spectral.load()
    print("rms / maximum, in diagonals of the input\n")
    print(f"| mesh | filter | input | {' | '.join(COLUMNS)} |")
    print(f"|---|---|---|{'---|' * len(COLUMNS)}")
    for mesh in [pathlib.Path(name) for name in sys.argv[1:]] or MESHES:
        if not mesh.exists():
            print(f"skipped: no {mesh}", file=sys.stderr)
            continue
        meshes = loaded(mesh)
        diagonal = meshes.current_mesh().bounding_box().diagonal()
        for name, (percent, options) in FILTERS.items():
            size = percent / 100 * diagonal
            cells = [cell(meshes, size, diagonal)]
            cells += [filtered_cell(mesh, size, diagonal, options | c) for c in COLUMNS.values()]
            print(f"| {mesh.stem} | {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
