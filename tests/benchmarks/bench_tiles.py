"""Memory and processor time of `filter` and `denoise` in tiles and as a whole, file to file.

    bench_tiles.py [--sides 800 3200] [--memory 2GB] [--command "denoise"] [--whole-below VERTICES]

Makes a bumpy torus of side^2 vertices chunk by chunk (800: 640,000 vertices, 3200: 10.24 million,
8944: 80 million), filters it in tiles and, below --whole-below vertices, as a whole. The memory is
the peak of the sum over the process tree of what no other process shares (resident, without pages
of files), sampled; in brackets with the pages of files that are mapped.
"""

from __future__ import annotations

import argparse
import shlex
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import psutil

_FACE = np.dtype([("n", "u1"), ("corners", "<i4", 3)])


def write_torus(path: Path, side: int) -> None:
    """Write a closed surface of side^2 vertices with bumps of many sizes, a row at a time."""
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {side * side}\nproperty float x\n"
        f"property float y\nproperty float z\nelement face {2 * side * side}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    rng = np.random.default_rng(side)
    v = np.linspace(0, 2 * np.pi, side, endpoint=False)
    with path.open("wb") as file:
        file.write(header.encode())
        for i in range(side):
            u = 2 * np.pi * i / side
            r = 1 + 0.15 * np.sin(5 * u) * np.cos(4 * v) + 0.02 * np.sin(23 * u + 11 * v)
            ring = 2.5 + r * np.cos(v)
            X = np.column_stack([ring * np.cos(u), ring * np.sin(u), r * np.sin(v)])
            X += 1.5 / side * rng.normal(size=X.shape)  # a tenth of an edge
            file.write(X.astype("<f4").tobytes())
        a = np.arange(side)
        b = np.roll(a, -1)
        for i in range(side):
            here, next_row = side * i, side * ((i + 1) % side)
            faces = np.zeros(2 * side, _FACE)
            faces["n"] = 3
            faces["corners"][::2] = np.column_stack([here + a, next_row + a, next_row + b])
            faces["corners"][1::2] = np.column_stack([here + a, next_row + b, here + b])
            file.write(faces.tobytes())


def measured(command: list[str]) -> tuple[float, float, float]:
    """Run a command; return its processor seconds, and peaks of memory without and with files."""
    process = psutil.Popen(command)
    own = whole = 0.0
    seconds: dict[int, float] = {}
    while process.poll() is None:
        sums = [0, 0]
        try:
            tree = [process, *process.children(recursive=True)]
        except psutil.Error:
            continue
        for one in tree:
            try:
                memory, times = one.memory_info(), one.cpu_times()
            except psutil.Error:
                continue
            sums[0] += memory.rss - getattr(memory, "shared", 0)
            sums[1] += memory.rss
            seconds[one.pid] = times.user + times.system
        own, whole = max(own, sums[0]), max(whole, sums[1])
        time.sleep(0.05)
    if process.returncode:
        sys.exit(f"{shlex.join(command)}: exit code {process.returncode}")
    return sum(seconds.values()), own, whole


def positions(path: Path, side: int) -> np.ndarray:
    """Return the rows of x, y and z of a file that `write_torus` or a filter has written."""
    content = path.open("rb").read(4096)
    begin = content.index(b"end_header\n") + len(b"end_header\n")
    kind = "<f8" if b"double x" in content else "<f4"
    return np.memmap(path, kind, "r", begin, (side * side, 3))


def main() -> None:
    """Print a row for each size and way."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sides", type=int, nargs="+", default=[800, 3200])
    parser.add_argument("--memory", default="2GB")
    parser.add_argument("--tiles", default="auto")
    parser.add_argument("--command", default="filter --feature-size 6e", help="with its options")
    parser.add_argument("--whole-below", type=int, default=1_000_000)
    parser.add_argument("--folder", type=Path, help="for the files; by default a temporary one")
    given = parser.parse_args()
    program = [sys.executable, "-m", "meshlab_spectral.cli", *shlex.split(given.command)]
    with tempfile.TemporaryDirectory(dir=given.folder) as folder:
        for side in given.sides:
            source, tiled, whole = (
                Path(folder) / f"{name}.ply" for name in ("mesh", "tiled", "whole")
            )
            write_torus(source, side)
            runs = [(tiled, ["--tiles", given.tiles, "--memory", given.memory])]
            if side * side < given.whole_below:
                runs.append((whole, ["--tiles", "off"]))
            for target, way in runs:
                seconds, own, all_pages = measured(
                    [*program, str(source), str(target), "-q", "--overwrite", *way]
                )
                print(
                    f"{side * side:>10} vertices, {' '.join(way)}: {seconds:.0f} processor s "
                    f"({seconds / side**2 * 1e6:.1f} a million), {own / 2**30:.2f} GiB "
                    f"({all_pages / 2**30:.2f})",
                    flush=True,
                )
            if len(runs) == 2:
                a, b = positions(tiled, side).astype(float), positions(whole, side).astype(float)
                diagonal = np.linalg.norm(np.ptp(b, axis=0))
                difference = np.linalg.norm(a - b, axis=1) / diagonal
                print(f"{'':>10} largest difference {difference.max():.1e} of the diagonal")
            for path in (source, tiled, whole):
                path.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
