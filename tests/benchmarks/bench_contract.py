"""The outcome of every filter of the plugin on real meshes, at three settings.

usage: bench_contract.py [--timeout SECONDS] [--most VERTICES] [--json FILE] [MESH ...]

One row per call: mesh, filter, setting, outcome, seconds, and the peak memory of the process above
that before the call. Errors and warnings follow the row in full. An outcome is "ok", "warning",
"error" (an exception of pymeshlab that leaves the mesh unchanged), or "FAILED": anything else, such
as a crash, coordinates that are not finite, or a changed mesh. The exit code is 1 if any failed.

MESH defaults to everything in ../shared/data next to the repository.
"""

from __future__ import annotations

import argparse
import json
import os
import pathlib
import select
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

from bench_defaults import forget_peak, peak_megabytes


class Call(NamedTuple):
    """A filter and its parameters; a feature size is in percent of the diagonal."""

    short: str
    setting: str
    parameters: dict[str, Any]


NAMES = {
    "filter": "apply_coord_spectral_filter_fractional",
    "denoise": "apply_coord_spectral_denoise",
    "equalizer": "apply_coord_spectral_equalizer",
    "quality": "apply_scalar_spectral_filter_per_vertex",
    "color": "apply_color_spectral_filter_per_vertex",
    "artefacts": "compute_scalar_spectral_artefacts_per_vertex",
    "harmonics": "compute_scalar_manifold_harmonic_per_vertex",
    "spectrum": "get_geometry_spectrum",
    "texture": "compute_scalar_surface_texture_per_vertex",
}
CALLS = [
    Call("filter", "default", {}),
    Call("filter", "strong", {"feature_size": 15.0}),
    Call("filter", "truncated", {"spectrum": "truncated", "basis_size": 300, "steps": 1}),
    Call("denoise", "default", {}),
    Call("denoise", "strong", {"strength": 5.0}),
    Call("denoise", "free", {"boundary": "free", "keep_creases": False}),
    Call("equalizer", "default", {}),
    Call("equalizer", "deep", {"gain_8x": 2.0}),
    Call("equalizer", "smooth", {"gain_2x": 0.0, "gain_1x": 0.0}),
    Call("quality", "default", {}),
    Call("quality", "strong", {"feature_size": 15.0}),
    Call("quality", "fixed", {"boundary": "fixed"}),
    Call("color", "default", {}),
    Call("color", "sharpen", {"filter_type": "high-pass", "stop_gain": 1.0, "pass_gain": 2.0}),
    Call("color", "fixed", {"boundary": "fixed"}),
    Call("artefacts", "default", {}),
    Call("artefacts", "strong", {"feature_size": 15.0}),
    Call("artefacts", "cotangent", {"laplacian": "cotangent"}),
    Call("harmonics", "default", {}),
    Call("harmonics", "large", {"basis_size": 300, "mode": 299}),
    Call("harmonics", "fixed", {"boundary": "fixed"}),
    Call("spectrum", "default", {}),
    Call("spectrum", "large", {"basis_size": 300}),
    Call("spectrum", "fixed", {"boundary": "fixed"}),
    Call("texture", "default", {}),
    Call("texture", "all", {"crease_angle": 180.0}),
    Call("texture", "cotangent", {"laplacian": "cotangent"}),
]
# Filters that may move vertices; the others must leave positions and faces bit-for-bit unchanged.
MOVES = {"filter", "denoise", "equalizer"}
# Filters of a signal, for which the height is used: files need not have one.
SIGNALS = {"quality", "color"}

_failed: list[Any] = []  # pymeshlab may crash when a MeshSet with an error is destroyed


def called(path: str, call: Call) -> dict[str, Any]:
    """Make one call in this process; return its row."""
    import numpy as np
    import pymeshlab
    from meshlab_spectral.plugin.library import last_warnings
    from meshlab_spectral.plugin.mesh_sets import reason_of

    mesh_set = pymeshlab.MeshSet()
    mesh_set.load_new_mesh(path)
    mesh = mesh_set.current_mesh()
    V, F = mesh.vertex_matrix().copy(), mesh.face_matrix().copy()
    parameters = dict(call.parameters)
    if "feature_size" in parameters:
        parameters["feature_size"] = pymeshlab.PercentageValue(parameters["feature_size"])
    if call.short in SIGNALS:
        mesh_set.compute_scalar_by_function_per_vertex(q="z")
        mesh_set.compute_color_from_scalar_per_vertex()
    row: dict[str, Any] = {
        "mesh": pathlib.Path(path).name,
        "vertices": len(V),
        "filter": call.short,
        "setting": call.setting,
        "texts": [],
    }
    before, begin = forget_peak(), time.perf_counter()
    try:
        report = mesh_set.apply_filter(NAMES[call.short], **parameters) or {}
        row["texts"] = last_warnings()
        row["outcome"] = "warning" if row["texts"] else "ok"
    except pymeshlab.PyMeshLabException as error:
        _failed.append(mesh_set)
        report = {}
        row["texts"] = [reason_of(error)]
        row["outcome"] = "error"
    row["seconds"] = time.perf_counter() - begin
    row["megabytes"] = peak_megabytes() - before

    mesh = mesh_set.current_mesh()
    numbers = [mesh.vertex_matrix(), *(np.asarray(value, float) for value in report.values())]
    if mesh.has_vertex_scalar():
        numbers.append(mesh.vertex_scalar_array())
    if not all(np.isfinite(array).all() for array in numbers):
        row |= {"outcome": "FAILED", "texts": ["numbers that are not finite"]}
    may_move = call.short in MOVES and row["outcome"] != "error"
    if not (may_move or np.array_equal(mesh.vertex_matrix(), V)):
        row |= {"outcome": "FAILED", "texts": ["vertices have moved"]}
    if not np.array_equal(mesh.face_matrix(), F):
        row |= {"outcome": "FAILED", "texts": ["faces have changed"]}
    return row


def make_calls(path: str, first: int, most: int) -> None:
    """Make the calls from number `first` on; print a row, or null where the mesh is too large."""
    import meshlab_spectral
    import pymeshlab

    meshlab_spectral.load()
    for call in CALLS[first:]:
        probe = pymeshlab.MeshSet()
        probe.load_new_mesh(path)
        too_large = probe.current_mesh().vertex_number() > most
        print("ROW", json.dumps(None if too_large else called(path, call)), flush=True)
    os._exit(0)  # without destroying a MeshSet


def rows_of(path: str, timeout: float, most: int) -> Iterator[dict[str, Any]]:
    """Yield the rows of a mesh; a process that crashes or hangs is replaced."""
    first = 0
    while first < len(CALLS):
        command = [sys.executable, __file__, path, "--first", str(first), "--most", str(most)]
        child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        assert child.stdout is not None
        while first < len(CALLS):
            line, begin = b"", time.monotonic()
            while not line.endswith(b"\n"):
                left = begin + timeout - time.monotonic()
                if left <= 0 or not select.select([child.stdout], [], [], left)[0]:
                    child.kill()
                    break
                part = os.read(child.stdout.fileno(), 1)
                if not part:
                    break
                line += part
            if line.startswith(b"ROW "):
                first += 1
                row = json.loads(line[4:])
                if row is not None:
                    yield row
            elif not line.endswith(b"\n"):
                call = CALLS[first]
                code = child.wait()
                what = f"more than {timeout:g} s" if code == -9 else f"exit status {code}"
                first += 1
                yield {
                    "mesh": pathlib.Path(path).name,
                    "vertices": 0,
                    "filter": call.short,
                    "setting": call.setting,
                    "outcome": "FAILED",
                    "seconds": time.monotonic() - begin,
                    "megabytes": 0.0,
                    "texts": [what],
                }
                break
        child.wait()
        child.stdout.close()


def default_meshes() -> list[str]:
    """Return the meshes next to the repository, smallest file first."""
    folder = pathlib.Path(__file__).resolve().parents[3] / "shared" / "data"
    files = [file for file in folder.iterdir() if file.suffix != ".md"]
    return [str(file) for file in sorted(files, key=lambda file: file.stat().st_size)]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="*", metavar="MESH")
    parser.add_argument("--timeout", type=float, default=600, help="seconds for one call")
    parser.add_argument("--most", type=int, default=10**9, help="leave out larger meshes")
    parser.add_argument("--json", type=pathlib.Path, help="append the rows to this file")
    parser.add_argument("--first", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.first is not None:
        make_calls(arguments.meshes[0], arguments.first, arguments.most)

    print(
        f"{'mesh':28}{'vertices':>8}  {'filter':11}{'setting':11}{'outcome':9}"
        f"{'seconds':>8}{'MB':>7}"
    )
    outcomes: Counter[str] = Counter()
    for mesh in arguments.meshes or default_meshes():
        for row in rows_of(mesh, arguments.timeout, arguments.most):
            outcomes[row["outcome"]] += 1
            print(
                f"{row['mesh']:28}{row['vertices']:8}  {row['filter']:11}{row['setting']:11}"
                f"{row['outcome']:9}{row['seconds']:8.2f}{row['megabytes']:7.0f}"
            )
            for text in row["texts"]:
                print(f"    {text}")
            sys.stdout.flush()
            if arguments.json:
                with arguments.json.open("a") as file:
                    file.write(json.dumps(row) + "\n")
    print(", ".join(f"{count} {outcome}" for outcome, count in outcomes.items()))
    sys.exit(1 if outcomes["FAILED"] else 0)


if __name__ == "__main__":
    main()
