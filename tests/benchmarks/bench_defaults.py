"""What most users do: open a mesh, leave every parameter at its default, press Apply.

usage: bench_defaults.py [--setting NAME] [--reference [TIMES]] [--timeout SECONDS] [MESH ...]

One row per mesh, each measured in a process of its own: seconds of the filter call (the least of
three, or of as many as fit into a fifth of a second), its ratios to MeshLab's Taubin smoothing with
50 and 10 steps and to its Laplacian smoothing with 100 on the same mesh in the same process, the
work, the process's peak memory above that before, and the warnings. With --reference also the
error, in tolerances: the estimate; the true error, on all but 0.1 % of the filtered surface and of
the input's; and its maximum. The truth is another scheme: the paper's with 16 (TIMES) times the
steps, at most 500, and with twice as many, extrapolated (twice the second minus the first).

MESH defaults to every mesh with faces in ../shared/data next to the repository.
"""

from __future__ import annotations

import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import time
from collections.abc import Iterable
from typing import Any

SETTINGS: dict[str, dict[str, Any]] = {
    "default": {},
    "low-pass-15": {"feature_size": 15},
    "conformal-15": {"feature_size": 15, "steps": 10, "basis_update": "conformal"},
    "boost-20": {
        "filter_type": "band-pass",
        "feature_size": 20,
        "stop_gain": 1.0,
        "pass_gain": 2.5,
    },
    "sharpen-2": {
        "filter_type": "high-pass",
        "feature_size": 2,
        "stop_gain": 1.0,
        "pass_gain": 2.0,
    },
}

SMOOTHINGS: dict[str, tuple[str, int]] = {
    "Taubin 50": ("apply_coord_taubin_smoothing", 50),
    "Taubin 10": ("apply_coord_taubin_smoothing", 10),
    "Lapl. 100": ("apply_coord_laplacian_smoothing", 100),
}
LARGE = 5000  # vertices; on smaller meshes the ratio is that of the overheads of calls
LONG = 2.0  # seconds; a call that takes longer is timed once,
LEAST_CALLS = 3  # others at least so many times,
ENOUGH = 0.2  # and for so many seconds in all: a single millisecond says little
UNRESOLVED_AREA = 1e-3
REFERENCE_STEPS = 16  # times those of the result
MOST_STEPS = 1000  # the maximum of the filter


def peak_megabytes() -> float:
    """Return the peak resident memory of this process."""
    status = pathlib.Path("/proc/self/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) / 1024


def forget_peak() -> float:
    """Reset the peak; return the memory that is resident now, in megabytes."""
    pathlib.Path("/proc/self/clear_refs").write_text("5")
    return peak_megabytes()


def measure(
    mesh: str, setting: str, reference_steps: int, smoothings: Iterable[str]
) -> dict[str, Any]:
    """Filter one mesh in this process; return its row, with ratios to some smoothings.

    With reference_steps > 0 also the error against that many times the steps of the result.
    """
    import meshlab_spectral
    import numpy as np
    import pymeshlab

    meshlab_spectral.load()
    options = dict(SETTINGS[setting])
    if "feature_size" in options:
        options["feature_size"] = pymeshlab.PercentageValue(options["feature_size"])

    def timed(call: Any) -> tuple[float, Any, Any]:
        """Call with new meshes: return the least time, the report and the vertices."""
        times: list[float] = []
        while sum(times) < ENOUGH or (len(times) < LEAST_CALLS and min(times) < LONG):
            meshes = pymeshlab.MeshSet()
            meshes.load_new_mesh(mesh)
            start = time.perf_counter()
            report = call(meshes)
            times.append(time.perf_counter() - start)
        return min(times), report, meshes.current_mesh().vertex_matrix().copy()

    def smoothed(name: str) -> Any:
        smoothing, steps = SMOOTHINGS[name]
        return lambda meshes: getattr(meshes, smoothing)(stepsmoothnum=steps)

    def filtered(**steps: int) -> Any:
        return lambda meshes: meshes.apply_coord_spectral_filter_fractional(**options, **steps)

    before = forget_peak()
    seconds, report, V = timed(filtered())
    row: dict[str, Any] = {
        "mesh": pathlib.Path(mesh).name,
        "vertices": len(V),
        "seconds": seconds,
        "ratios": {name: seconds / timed(smoothed(name))[0] for name in smoothings},
        "megabytes": peak_megabytes() - before,
        "steps": report["steps"],
        "factorizations": report["factorizations"],
        "solves": report["solves"],
        "warned": not (report["tolerance_reached"] and report["accuracy_reached"]),
        "estimate": report["step_error"],
        "feature_size": report["feature_size"],
        "singular_part": report["singular_part"],
    }
    if reference_steps:
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(mesh)
        X, F = meshes.current_mesh().vertex_matrix(), meshes.current_mesh().face_matrix()
        tolerance = 5e-4 * meshes.current_mesh().bounding_box().diagonal()
        row["estimate"] /= tolerance
        K = min(reference_steps * report["steps"], MOST_STEPS // 2)
        _, _, coarse = timed(filtered(steps=K))
        _, _, fine = timed(filtered(steps=2 * K))
        limit = 2 * fine - coarse
        error = np.linalg.norm(V - limit, axis=1) / tolerance
        for name, shape in (("input", X), ("result", limit)):
            sides = shape[F[:, 1:]] - shape[F[:, :1]]
            area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
            mass = np.bincount(F.ravel(), np.repeat(area, 3), len(V))
            order = np.argsort(error)
            share = np.cumsum(mass[order]) / mass.sum()
            row[f"error_of_{name}"] = error[order][np.searchsorted(share, 1 - UNRESOLVED_AREA)]
            row["largest_error"] = error[mass > 0].max()
    return row


def measured(
    mesh: str,
    setting: str = "default",
    reference_steps: int = 0,
    smoothings: Iterable[str] = tuple(SMOOTHINGS),
    timeout: float = 1800,
) -> dict[str, Any]:
    """Filter one mesh in a process of its own; return its row, or one with its "failure"."""
    options = ["--one", "--setting", setting, "--over", *smoothings]
    if reference_steps:
        options += ["--reference", str(reference_steps)]
    command = [sys.executable, __file__, mesh, *options]
    name = pathlib.Path(mesh).name
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        return {"mesh": name, "failure": f"> {timeout:.0f} s"}
    if run.returncode != 0:
        lines = run.stderr.strip().splitlines() or [f"exit status {run.returncode}"]
        return {"mesh": name, "failure": lines[-1][:200]}
    row: dict[str, Any] = json.loads(run.stdout.splitlines()[-1])
    return row


def default_meshes() -> list[str]:
    """Return the meshes with faces next to the repository, smallest file first."""
    folder = pathlib.Path(__file__).resolve().parents[3] / "shared" / "data"
    files = [f for f in folder.iterdir() if f.suffix != ".md" and "points" not in f.name]
    return [str(f) for f in sorted(files, key=lambda f: f.stat().st_size)]


def printed(row: dict[str, Any]) -> str:
    """Return the row as text."""
    if "failure" in row:
        return f"{row['mesh']:28} {row['failure']}"
    text = (
        f"{row['mesh']:28}{row['vertices']:8}{row['seconds']:9.3f}"
        + "".join(f"{ratio:10.2f}" for ratio in row["ratios"].values())
        + f"{row['steps']:6}{row['factorizations']:5}{row['solves']:7}"
        + f"{row['megabytes']:8.0f}{'  warns' if row['warned'] else '':8}"
    )
    if "estimate" in row and "largest_error" in row:
        text += (
            f"{row['estimate']:10.2f}{row['error_of_result']:9.2f}{row['error_of_input']:8.2f}"
            f"{row['largest_error']:9.2f}"
        )
    return text


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="*", metavar="MESH")
    parser.add_argument("--setting", choices=SETTINGS, default="default")
    parser.add_argument(
        "--reference", type=int, nargs="?", default=0, const=REFERENCE_STEPS, metavar="TIMES"
    )
    parser.add_argument("--timeout", type=float, default=1800)
    parser.add_argument("--json", type=pathlib.Path, help="append the rows to this file")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--over", nargs="*", default=list(SMOOTHINGS), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    setting, reference = arguments.setting, arguments.reference
    if arguments.one:
        print(json.dumps(measure(arguments.meshes[0], setting, reference, arguments.over)))
        return

    print(
        f"{'mesh':28}{'vertices':>8}{'seconds':>9}"
        + "".join(f"{'/' + name:>10}" for name in SMOOTHINGS)
        + f"{'steps':>6}{'fact':>5}{'solves':>7}{'MB':>8}{'':8}"
        + (
            f"{'estimate':>10}{'result':>9}{'input':>8}{'at most':>9}"
            if arguments.reference
            else ""
        )
    )
    rows: list[dict[str, Any]] = []
    for mesh in arguments.meshes or default_meshes():
        row = measured(mesh, setting, reference, timeout=arguments.timeout)
        if "failure" not in row:
            rows.append(row)
        print(printed(row), flush=True)
        if arguments.json:
            with arguments.json.open("a") as file:
                file.write(json.dumps(row) + "\n")
    for name in SMOOTHINGS if rows else ():
        ratios = [row["ratios"][name] for row in rows]
        large = [row["ratios"][name] for row in rows if row["vertices"] >= LARGE]
        print(
            f"over {name}: {statistics.geometric_mean(ratios):.2f} (geometric mean of {len(rows)}),"
            f" at most {max(ratios):.2f}, {max(large, default=0):.2f} of {LARGE:,} vertices or more"
        )
    print(f"{sum(row['warned'] for row in rows)} with a warning")


if __name__ == "__main__":
    main()
