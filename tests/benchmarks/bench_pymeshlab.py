"""Time and peak memory of the whole filter call through pymeshlab, each in a fresh process.

usage: bench_pymeshlab.py [MESH]

MESH defaults to the 40k-vertex dragon next to the repository or, if that is absent, to the bunny
that comes with pymeshlab. Peak memory is that of the process (VmHWM), with Python, pymeshlab
and the mesh; subtract the line "load only" for the filter's share.
"""

import json
import pathlib
import subprocess
import sys
import time

from bench_defaults import peak_megabytes

CASES = {
    "load only": None,
    "gaussian low-pass 15 %, K = 1": {"steps": 1, "basis_update": "none"},
    "gaussian low-pass 15 %, conformal K = 10": {"steps": 10, "basis_update": "conformal"},
    "truncated, k = 300, K = 1": {"steps": 1, "spectrum": "truncated"},
}


def measure(mesh: str, case: str) -> dict[str, float]:
    """Run one case in this process and return what it took."""
    import meshlab_spectral
    import pymeshlab

    meshlab_spectral.load()
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(mesh)
    start = time.perf_counter()
    report = {}
    if CASES[case] is not None:
        report = meshes.apply_coord_spectral_filter_fractional(
            feature_size=pymeshlab.PercentageValue(15), **CASES[case]
        )
    return {
        "seconds": time.perf_counter() - start,
        "megabytes": peak_megabytes(),
        "vertices": meshes.current_mesh().vertex_number(),
        "factorizations": report.get("factorizations", 0),
        "solves": report.get("solves", 0),
    }


def measured(mesh: str, case: str) -> dict[str, float]:
    """Run one case in a process of its own and return what it took."""
    command = [sys.executable, __file__, mesh, case]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    row: dict[str, float] = json.loads(out.splitlines()[-1])
    return row


def default_mesh() -> pathlib.Path:
    """Return the dragon if it is there, else pymeshlab's bunny."""
    dragon = pathlib.Path(__file__).parents[3] / "shared" / "data" / "dragon_40k.ply"
    if dragon.exists():
        return dragon
    import pymeshlab

    return pathlib.Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / "bunny.obj"


def main() -> None:
    """Measure every case in a process of its own and print a table."""
    if len(sys.argv) == 3:
        print(json.dumps(measure(sys.argv[1], sys.argv[2])))
        return
    mesh = sys.argv[1] if len(sys.argv) == 2 else str(default_mesh())
    print(f"{mesh}\n{'case':44}{'seconds':>9}{'peak MB':>9}{'factor.':>9}{'solves':>8}")
    for case in CASES:
        row = measured(mesh, case)
        print(
            f"{case:44}{row['seconds']:9.2f}{row['megabytes']:9.0f}"
            f"{row['factorizations']:9.0f}{row['solves']:8.0f}"
        )


if __name__ == "__main__":
    main()
