"""Memory of many runs in one process, and of one run on a large mesh, with and without a limit.

usage: bench_memory.py [--runs N] [--subdivisions N] [MESH]

Prints the resident memory of a process after 10 runs of each filter and after all; then, of MESH
with every triangle divided into four N times, the seconds and the peak of one step, the mesh
included, and the outcome of a batch with a memory limit of 2 GB.

MESH defaults to ../shared/data/dragon_40k.ply next to the repository.
"""

from __future__ import annotations

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator

from bench_contract import CALLS, NAMES, SIGNALS
from bench_defaults import peak_megabytes

FEW_RUNS = 10


def resident_megabytes() -> float:
    """Return the resident memory of this process."""
    status = pathlib.Path("/proc/self/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


def measured_runs(runs: int) -> Iterator[tuple[str, float, float]]:
    """Run each filter again and again on a small sphere.

    Yield its name, and the resident memory after the first few runs and after all.
    """
    import meshlab_spectral
    import pymeshlab

    meshlab_spectral.load()
    for call in [call for call in CALLS if call.setting == "default"]:
        few = 0.0
        for run in range(runs):
            meshes = pymeshlab.MeshSet()
            meshes.create_sphere(subdiv=4)
            if call.short in SIGNALS:
                meshes.compute_scalar_by_function_per_vertex(q="z")
                meshes.compute_color_from_scalar_per_vertex()
            meshes.apply_filter(NAMES[call.short], **call.parameters)
            if run == FEW_RUNS - 1:
                few = resident_megabytes()
        yield call.short, few, resident_megabytes()


def print_runs(runs: int) -> None:
    """Print the memory of many runs."""
    print(f"{'filter':11}{'MB after ' + str(FEW_RUNS):>12}{'after ' + str(runs):>12}")
    for name, few, all_runs in measured_runs(runs):
        print(f"{name:11}{few:12.1f}{all_runs:12.1f}", flush=True)


def write_large(mesh: str, subdivisions: int, target: str) -> None:
    """Write the subdivided mesh."""
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(mesh)
    meshes.meshing_surface_subdivision_midpoint(
        iterations=subdivisions, threshold=pymeshlab.PureValue(0)
    )
    meshes.save_current_mesh(target)


def measure_large(mesh: str) -> None:
    """Filter the large mesh in one step."""
    import meshlab_spectral
    import pymeshlab

    meshlab_spectral.load()
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(mesh)
    begin = time.perf_counter()
    meshes.apply_coord_spectral_filter_fractional(steps=1)
    seconds = time.perf_counter() - begin
    count = meshes.current_mesh().vertex_number()
    print(f"{count} vertices, one step: {seconds:.1f} s, peak {peak_megabytes():.0f} MB")


def measure_limited(mesh: str, folder: str) -> None:
    """Have a batch of one worker with 2 GB filter the large mesh."""
    command = ["-m", "meshlab_spectral.cli", "batch", mesh, "--output", folder, "--steps", "1"]
    limits = ["--workers", "1", "--memory-limit", "2GB"]
    subprocess.run([sys.executable, *command, *limits], capture_output=True, check=False)
    report = pathlib.Path(folder, "batch_report.jsonl").read_text().splitlines()
    record = next(r for r in map(json.loads, report) if "outcome" in r)
    print(f"under 2 GB: {record['outcome']}: {record['reason']}")


def main() -> None:
    """Print both."""
    data = pathlib.Path(__file__).resolve().parents[3] / "shared" / "data"
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="?", metavar="MESH", default=str(data / "dragon_40k.ply"))
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--subdivisions", type=int, default=3)
    parser.add_argument("--large", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.large is not None:
        measure_large(arguments.large)
        return
    print_runs(arguments.runs)
    with tempfile.TemporaryDirectory() as folder:
        large = str(pathlib.Path(folder, "large.ply"))
        write_large(arguments.mesh, arguments.subdivisions, large)
        subprocess.run([sys.executable, __file__, "--large", large], check=True)
        measure_limited(large, str(pathlib.Path(folder, "out")))


if __name__ == "__main__":
    main()
