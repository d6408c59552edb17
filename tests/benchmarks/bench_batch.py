"""Throughput and memory of a batch of small meshes, against one process.

usage: bench_batch.py [--meshes 1000] [--workers 2] [--vertices 5000]

The meshes are tori with noise, made in a temporary folder, and filtered with the defaults. One
process: a plain loop of pymeshlab that loads, filters and saves, without hashes, report or safe
writing. The batch runs with one worker and with several; meanwhile the memory of all its processes
is sampled twice a second.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
import psutil

LOOP = """
import sys, time
from pathlib import Path
import meshlab_spectral, pymeshlab
source, target = map(Path, sys.argv[1:])
begin = time.monotonic()
meshlab_spectral.load()
for path in sorted(source.iterdir()):
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(path))
    ms.apply_coord_spectral_filter_fractional()
    ms.save_current_mesh(str(target / path.name))
print(time.monotonic() - begin)
"""


def torus(vertices: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    n = round(vertices**0.5)
    u, v = (angles.ravel() for angles in np.meshgrid(*[np.arange(n) * 2 * np.pi / n] * 2))
    radius = 1 + 0.4 * np.cos(v)
    V = np.column_stack([radius * np.cos(u), radius * np.sin(u), 0.4 * np.sin(v)])
    i, j = (index.ravel() for index in np.meshgrid(np.arange(n), np.arange(n)))
    a, b = i + n * j, (i + 1) % n + n * j
    c, d = (i + 1) % n + n * ((j + 1) % n), i + n * ((j + 1) % n)
    F = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return V + 0.01 * rng.standard_normal(V.shape), F


def write_ply(path: Path, V: np.ndarray, F: np.ndarray) -> None:
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(V)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(F)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(F), dtype=[("n", "u1"), ("corners", "<i4", 3)])
    faces["n"], faces["corners"] = 3, F
    path.write_bytes(header.encode() + V.astype("<f8").tobytes() + faces.tobytes())


def seconds_of_loop(source: Path, target: Path) -> float:
    target.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", LOOP, str(source), str(target)],
        check=True,
        capture_output=True,
        text=True,
    )
    return float(done.stdout.splitlines()[-1])


class MemoryLog(threading.Thread):
    """Resident bytes of the descendants of a process, by process, over time."""

    def __init__(self, pid: int) -> None:
        super().__init__(daemon=True)
        self.pid = pid
        self.seen: list[tuple[float, dict[int, int]]] = []

    def run(self) -> None:
        begin = time.monotonic()
        while True:
            try:
                below = psutil.Process(self.pid).children(recursive=True)
            except psutil.NoSuchProcess:
                return
            used = {}
            for process in below:
                try:
                    used[process.pid] = process.memory_info().rss
                except psutil.Error:
                    continue
            self.seen.append((time.monotonic() - begin, used))
            time.sleep(0.5)


def seconds_of_batch(source: Path, target: Path, workers: int) -> tuple[float, MemoryLog]:
    command = [sys.executable, "-m", "meshlab_spectral.cli", "batch", str(source)]
    command += ["--output", str(target), "--workers", str(workers)]
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.PIPE)
    log = MemoryLog(process.pid)
    log.start()
    said, _ = process.communicate()
    seconds = time.monotonic() - begin
    assert process.returncode == 0, said
    return seconds, log


def tell_memory(log: MemoryLog) -> None:
    mebibyte = 2**20
    print("  time    processes   all MiB   largest MiB")
    for part in np.array_split(np.arange(len(log.seen)), min(10, len(log.seen))):
        looks = [log.seen[k] for k in part]
        total = max(sum(used.values()) for _, used in looks)
        largest = max(max(used.values(), default=0) for _, used in looks)
        count = max(len(used) for _, used in looks)
        print(f"{looks[-1][0]:6.1f} {count:12} {total / mebibyte:9.0f} {largest / mebibyte:13.0f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--meshes", type=int, default=1000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--vertices", type=int, default=5000)
    asked = parser.parse_args()
    rng = np.random.default_rng(6)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source = folder / "in"
        source.mkdir()
        for number in range(asked.meshes):
            write_ply(source / f"{number:05}.ply", *torus(asked.vertices, rng))
        loop = seconds_of_loop(source, folder / "loop")
        print(f"{asked.meshes} meshes of {round(asked.vertices**0.5) ** 2} vertices")
        print(f"one process, plain loop: {loop:7.1f} s {asked.meshes / loop:7.1f} meshes/s")
        for workers in (1, asked.workers):
            seconds, log = seconds_of_batch(source, folder / f"out{workers}", workers)
            print(
                f"batch, {workers} workers:        {seconds:7.1f} s "
                f"{asked.meshes / seconds:7.1f} meshes/s, {loop / seconds:.2f} times the loop"
            )
        tell_memory(log)


if __name__ == "__main__":
    main()
