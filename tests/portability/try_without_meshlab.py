"""Tries an installed wheel without pymeshlab, Qt, X and GL: arrays, and a file of each format.

usage: python try_without_meshlab.py FOLDER    of files, named in its list.txt
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path

import meshlab_spectral
import numpy as np


def main() -> None:
    """Run every command that needs no MeshLab."""
    assert importlib.util.find_spec("pymeshlab") is None
    n = 40
    u, v = (a.ravel() for a in np.meshgrid(*2 * [2 * np.pi * np.arange(n) / n]))
    noise = np.random.default_rng(0).normal(0, 0.005, n * n)
    ring = 2 + (1 + noise) * np.cos(v)
    V = np.column_stack([ring * np.cos(u), ring * np.sin(u), (1 + noise) * np.sin(v)])
    i = np.arange(n * n).reshape(n, n)
    right, up = np.roll(i, -1, 1), np.roll(i, -1, 0)
    corner = np.roll(right, -1, 0)
    F = np.array([[i, right, corner], [i, corner, up]]).reshape(2, 3, -1)
    X, report = meshlab_spectral.denoise_mesh(V, F.transpose(0, 2, 1).reshape(-1, 3))
    print(report["summary"])
    assert X.shape == V.shape
    samples = Path(sys.argv[1])
    files = [samples / line for line in (samples / "list.txt").read_text().splitlines()]
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        for file in files:
            for task in ("filter", "denoise"):
                (out / task).mkdir(exist_ok=True)
                command(task, file, out / task / file.name, "--overwrite")
            command("info", file)
        command("spectrum", files[0])
        one_of_each_name = {file.name: file for file in files}
        command("batch", *one_of_each_name.values(), "--output", out / "batch", "--workers", "2")
        assert {file.name for file in (out / "batch").iterdir()} >= one_of_each_name.keys()
    print(f"without pymeshlab: {len(files)} files, every command")


def command(*arguments: object) -> None:
    """Run `meshlab-spectral`, which must succeed."""
    done = subprocess.run(
        ["meshlab-spectral", *map(str, arguments)], capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, (arguments, done.stderr)


if __name__ == "__main__":
    main()
